#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/cif_tables.h"
#include "io/file_text.h"

namespace ink {

namespace {

using Path = std::filesystem::path;
using Names = std::vector<std::string>;

/// More copies than any virus has; what goes beyond is damage.
constexpr std::size_t kMostMotions = 100'000;

[[noreturn]] void refuse(const Path& file, const CifValue& value, std::string_view problem) {
    throw InputError(file, value.line,
                     fmt::format("{} in the description of the assembly, {}; repair or remove it",
                                 problem, excerpt(value.text)));
}

/// "1-3,5" as the names 1, 2, 3, 5.
Names expand(std::string_view list, const Path& file, const CifValue& value) {
    Names names;
    for (const std::string_view entry : split(list, ',')) {
        const std::size_t dash = entry.find('-', 1);
        const auto first = parse_int(entry.substr(0, dash));
        const auto last =
            dash == std::string_view::npos ? std::nullopt : parse_int(entry.substr(dash + 1));
        if (!first || !last) {
            names.emplace_back(entry);
            continue;
        }
        if (*last - *first > static_cast<std::int64_t>(kMostMotions)) {
            refuse(file, value, "too many operators");
        }
        for (auto k = *first; k <= *last; ++k) names.push_back(std::to_string(k));
    }
    return names;
}

/// The groups of an operator expression: "(X0)(1-60)" or "1,2,3".
std::vector<Names> operator_groups(std::string_view text, const Path& file, const CifValue& value) {
    std::vector<Names> groups;
    if (text.find('(') == std::string_view::npos) return {expand(text, file, value)};
    while (!(text = trim(text)).empty()) {
        const std::size_t end = text.find(')');
        if (text.front() != '(' || end == std::string_view::npos) {
            refuse(file, value, "brackets that do not match");
        }
        groups.push_back(expand(text.substr(1, end - 1), file, value));
        text.remove_prefix(end + 1);
    }
    return groups;
}

/// First `inner`, then `outer`.
Motion after(const Motion& outer, const Motion& inner) {
    Motion both;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t col = 0; col < 3; ++col) {
            double sum = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += outer.rotation[3 * row + k] * inner.rotation[3 * k + col];
            }
            both.rotation[3 * row + col] = sum;
        }
    }
    both.shift = outer(inner.shift);
    return both;
}

class Operators {
  public:
    Operators(const CifTables& tables, const Path& file) : tables_(tables), file_(file) {
        const auto& names = column(tables, "_pdbx_struct_oper_list.id");
        for (std::size_t i = 0; i < names.size(); ++i) {
            motions_.emplace(plain_value(names[i].text), read(i, names[i]));
        }
    }

    std::vector<Motion> expression(const CifValue& value) const {
        std::vector<Motion> motions{Motion{}};
        for (const Names& group : operator_groups(plain_value(value.text), file_, value)) {
            if (group.size() * motions.size() > kMostMotions) {
                refuse(file_, value, "too many operators");
            }
            // Of "(A)(B)", B is done first.
            std::vector<Motion> next;
            for (const Motion& outer : motions) {
                for (const std::string& name : group) {
                    const auto found = motions_.find(name);
                    if (found == motions_.end()) refuse(file_, value, "an unknown operator");
                    next.push_back(after(outer, found->second));
                }
            }
            motions = std::move(next);
        }
        return motions;
    }

  private:
    double number(const std::string& tag, std::size_t row, const CifValue& name) const {
        const auto& values = column(tables_, "_pdbx_struct_oper_list." + tag);
        if (row >= values.size()) refuse(file_, name, "an operator without its matrix");
        const auto value = parse_double(without_uncertainty(plain_value(values[row].text)));
        if (!value || !(std::abs(*value) <= kLargestCoordinate)) {
            refuse(file_, values[row], "not a number");
        }
        return *value;
    }
    Motion read(std::size_t row, const CifValue& name) const {
        Motion motion;
        for (std::size_t k = 0; k < 9; ++k) {
            motion.rotation[k] =
                number(fmt::format("matrix[{}][{}]", k / 3 + 1, k % 3 + 1), row, name);
        }
        motion.shift = {number("vector[1]", row, name), number("vector[2]", row, name),
                        number("vector[3]", row, name)};
        return motion;
    }

    const CifTables& tables_;
    const Path& file_;
    std::map<std::string, Motion, std::less<>> motions_;
};

}  // namespace

std::vector<Assembly> cif_assemblies(const CifTables& tables, const Path& file) {
    const auto& names = column(tables, "_pdbx_struct_assembly_gen.assembly_id");
    const auto& expressions = column(tables, "_pdbx_struct_assembly_gen.oper_expression");
    const auto& chains = column(tables, "_pdbx_struct_assembly_gen.asym_id_list");
    if (names.size() != expressions.size() || names.size() != chains.size()) return {};
    const Operators operators(tables, file);
    std::vector<Assembly> assemblies;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view name = plain_value(names[i].text);
        if (assemblies.empty() || assemblies.back().name != name) {
            assemblies.push_back({std::string(name), {}});
        }
        Assembly::Copies copies;
        for (const std::string_view chain : split(plain_value(chains[i].text), ',')) {
            copies.asyms.emplace_back(chain);
        }
        copies.motions = operators.expression(expressions[i]);
        assemblies.back().copies.push_back(std::move(copies));
    }
    return assemblies;
}

}  // namespace ink
