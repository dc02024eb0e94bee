#pragma once

#include <cmath>
#include <limits>

namespace ink {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Three components: a point, a direction or a normal, as the name of the variable says.
template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3 operator*(Vec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vec3 operator*(T s, Vec3 a) { return a * s; }
    friend constexpr Vec3 operator/(Vec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
    friend constexpr bool operator==(Vec3 a, Vec3 b) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
T length(Vec3<T> a) {
    return std::sqrt(dot(a, a));
}

/// `a` scaled to length 1; `a` must not be zero.
template <class T>
Vec3<T> normalize(Vec3<T> a) {
    return a / length(a);
}

template <class T>
bool is_finite(Vec3<T> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

constexpr Vec3d to_double(Vec3f a) { return {a.x, a.y, a.z}; }
constexpr Vec3f to_float(Vec3d a) {
    return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

/// A point or a step on the screen, in pixels: x right, y down.
template <class T>
struct Vec2 {
    T x{}, y{};

    friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr Vec2 operator*(Vec2 a, T s) { return {a.x * s, a.y * s}; }
    friend constexpr bool operator==(Vec2 a, Vec2 b) = default;
};

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;

template <class T>
constexpr T dot(Vec2<T> a, Vec2<T> b) {
    return a.x * b.x + a.y * b.y;
}

/// Positive where `b` is clockwise of `a` on the screen.
template <class T>
constexpr T cross(Vec2<T> a, Vec2<T> b) {
    return a.x * b.y - a.y * b.x;
}

template <class T>
T length(Vec2<T> a) {
    return std::sqrt(dot(a, a));
}

constexpr Vec2d to_double(Vec2f a) { return {a.x, a.y}; }
constexpr Vec2f to_float(Vec2d a) { return {static_cast<float>(a.x), static_cast<float>(a.y)}; }

}  // namespace ink
