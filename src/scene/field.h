#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ink {

/// A quantity that varies over atoms or particles: charge, velocity, stress.
struct Field {
    std::string name;
    std::size_t components = 1;
    std::vector<float> values;  ///< the components of entry 0, then those of entry 1, ...
    /// Of a field of words: those that there are, in order, which the values count from 0 on.
    std::vector<std::string> words{};
};

/// What a field holds, for those who ask before they draw.
struct FieldSummary {
    std::string name;
    std::size_t components = 1;
    double least =
        0.0;  ///< of all components, over the finite values; least > most: none is finite
    double most = 0.0;
    /// Of a field of words: those that there are, in order; it has no range.
    std::vector<std::string> words{};
};

/// One number an entry: of a field by its name (of several components: the length of the vector),
/// or of a component by "name.x" (y, z, w) or "name.0" (from 0 on). Empty where there is no such
/// field.
std::vector<float> scalar_values(std::span<const Field> fields, std::string_view name);

/// The words of a field of that name; none where it holds numbers, or is not there.
std::span<const std::string> words_of(std::span<const Field> fields, std::string_view name);

/// The finite values' range.
FieldSummary summarize(const Field& field);

/// "charge, velocity (3)": for messages.
std::string field_names(std::span<const Field> fields);

}  // namespace ink
