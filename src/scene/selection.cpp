#include "scene/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "scene/elements.h"

namespace ink {

namespace {

using Mask = std::vector<std::uint8_t>;
using AtomTest = bool (*)(const Molecule&, std::size_t);

bool is_kind(const Molecule& m, std::size_t atom, ResidueKind kind) {
    const Residue* const residue = m.residue(atom);
    return residue != nullptr && residue->kind == kind;
}

bool is_polymer(const Molecule& m, std::size_t atom) {
    return is_kind(m, atom, ResidueKind::protein) || is_kind(m, atom, ResidueKind::nucleic);
}

/// N, CA, C, O of proteins; the sugar and phosphate of nucleic acids.
bool is_backbone(const Molecule& m, std::size_t atom) {
    if (m.atom_names.empty() || !is_polymer(m, atom)) return false;
    const std::string_view name = to_text(m.atom_names[atom]);
    if (is_kind(m, atom, ResidueKind::protein)) {
        return name == "N" || name == "CA" || name == "C" || name == "O" || name == "OXT";
    }
    return name.ends_with('\'') || name.ends_with('*') || name == "P" || name.starts_with("OP") ||
           name == "O1P" || name == "O2P" || name == "O3P";
}

constexpr std::array<std::pair<std::string_view, AtomTest>, 21> kClasses{{
    {"all", [](const Molecule&, std::size_t) { return true; }},
    {"none", [](const Molecule&, std::size_t) { return false; }},
    {"protein",
     [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::protein); }},
    {"nucleic",
     [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::nucleic); }},
    {"polymer", is_polymer},
    {"water", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::water); }},
    {"waters", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::water); }},
    {"solvent", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::water); }},
    {"ligand", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::other); }},
    {"ligands", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::other); }},
    {"organic", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::other); }},
    {"ion", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::ion); }},
    {"ions", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::ion); }},
    {"inorganic", [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::ion); }},
    {"hydrogen", [](const Molecule& m, std::size_t i) { return m.elements[i] == 1; }},
    {"hydrogens", [](const Molecule& m, std::size_t i) { return m.elements[i] == 1; }},
    {"hydro", [](const Molecule& m, std::size_t i) { return m.elements[i] == 1; }},
    {"backbone", is_backbone},
    {"sidechain",
     [](const Molecule& m, std::size_t i) { return is_polymer(m, i) && !is_backbone(m, i); }},
    {"polymer.protein",
     [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::protein); }},
    {"polymer.nucleic",
     [](const Molecule& m, std::size_t i) { return is_kind(m, i, ResidueKind::nucleic); }},
}};

enum class Property : std::uint8_t {
    chain,
    residue_name,
    residue_number,
    atom_name,
    element,
    entity
};

constexpr std::array<std::pair<std::string_view, Property>, 9> kProperties{{
    {"chain", Property::chain},
    {"resn", Property::residue_name},
    {"resname", Property::residue_name},
    {"resi", Property::residue_number},
    {"resid", Property::residue_number},
    {"name", Property::atom_name},
    {"elem", Property::element},
    {"element", Property::element},
    {"entity", Property::entity},
}};

enum class Comparison : std::uint8_t { less, less_equal, greater, greater_equal, equal };

constexpr std::array<std::pair<std::string_view, Comparison>, 6> kComparisons{{
    {"<=", Comparison::less_equal},
    {">=", Comparison::greater_equal},
    {"==", Comparison::equal},
    {"<", Comparison::less},
    {">", Comparison::greater},
    {"=", Comparison::equal},
}};

bool holds(Comparison comparison, double a, double b) {
    switch (comparison) {
        case Comparison::less: return a < b;
        case Comparison::less_equal: return a <= b;
        case Comparison::greater: return a > b;
        case Comparison::greater_equal: return a >= b;
        case Comparison::equal: return a == b;
    }
    return false;
}

template <class Table>
auto find(const Table& table, std::string_view word) -> std::optional<decltype(table[0].second)> {
    for (const auto& [name, value] : table) {
        if (name == word) return value;
    }
    return std::nullopt;
}

}  // namespace

struct Selection::Node {
    using Children = std::vector<std::shared_ptr<const Node>>;
    std::function<Mask(const Molecule&, const Children&)> evaluate;
    Children children;
};

namespace {

using Node = Selection::Node;
using NodePointer = std::shared_ptr<const Node>;

NodePointer make_node(std::function<Mask(const Molecule&, const Node::Children&)> evaluate,
                      Node::Children children = {}) {
    return std::make_shared<const Node>(Node{std::move(evaluate), std::move(children)});
}

template <class Test>
NodePointer atom_node(Test test) {
    return make_node([test](const Molecule& molecule, const Node::Children&) {
        Mask mask(molecule.atom_count());
        for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = test(molecule, i) ? 1 : 0;
        return mask;
    });
}

template <class Combine>
NodePointer pair_node(NodePointer a, NodePointer b, Combine combine) {
    return make_node(
        [combine](const Molecule& molecule, const Node::Children& children) {
            Mask mask = children[0]->evaluate(molecule, children[0]->children);
            const Mask other = children[1]->evaluate(molecule, children[1]->children);
            for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = combine(mask[i], other[i]);
            return mask;
        },
        {std::move(a), std::move(b)});
}

NodePointer not_node(NodePointer a) {
    return make_node(
        [](const Molecule& molecule, const Node::Children& children) {
            Mask mask = children[0]->evaluate(molecule, children[0]->children);
            for (std::uint8_t& entry : mask) entry = entry == 0 ? 1 : 0;
            return mask;
        },
        {std::move(a)});
}

NodePointer field_node(std::string field, Comparison comparison, double value) {
    return make_node([=](const Molecule& molecule, const Node::Children&) {
        const std::vector<float> values = scalar_values(molecule.fields, field);
        if (values.size() != molecule.atom_count()) {
            throw Error(
                fmt::format("--select: the atoms have no field '{}'; they have {}", field,
                            molecule.fields.empty() ? "none" : field_names(molecule.fields)));
        }
        Mask mask(values.size());
        for (std::size_t i = 0; i < mask.size(); ++i) {
            mask[i] = holds(comparison, values[i], value) ? 1 : 0;
        }
        return mask;
    });
}

struct Range {
    std::int64_t first, last;
};

/// "35", "10-20", "-5", "-5--2".
std::optional<Range> parse_range(std::string_view text) {
    if (const auto number = parse_int(text)) return Range{*number, *number};
    const std::size_t dash = text.find('-', 1);
    if (dash == std::string_view::npos) return std::nullopt;
    const auto first = parse_int(text.substr(0, dash));
    const auto last = parse_int(text.substr(dash + 1));
    if (!first || !last) return std::nullopt;
    return Range{*first, *last};
}

NodePointer number_node(std::vector<Range> ranges) {
    return atom_node([ranges = std::move(ranges)](const Molecule& m, std::size_t i) {
        const Residue* const residue = m.residue(i);
        return residue != nullptr && std::ranges::any_of(ranges, [&](const Range& range) {
                   return residue->number >= range.first && residue->number <= range.last;
               });
    });
}

NodePointer element_node(std::vector<std::uint8_t> numbers) {
    return atom_node([numbers = std::move(numbers)](const Molecule& m, std::size_t i) {
        return std::ranges::find(numbers, m.elements[i]) != numbers.end();
    });
}

/// The text of a property that is compared with words.
std::string_view property_text(const Molecule& m, std::size_t atom, Property property) {
    if (property == Property::atom_name) {
        return m.atom_names.empty() ? std::string_view() : to_text(m.atom_names[atom]);
    }
    const Residue* const residue = m.residue(atom);
    if (residue == nullptr) return {};
    if (property == Property::chain) return m.chains[residue->chain];
    if (property == Property::entity) {
        return m.entities.empty() ? std::string_view()
                                  : std::string_view(m.entities[residue->entity]);
    }
    return residue->name;
}

NodePointer word_node(Property property, std::vector<std::string> words) {
    return atom_node([property, words = std::move(words)](const Molecule& m, std::size_t i) {
        const std::string_view text = property_text(m, i, property);
        return !text.empty() && std::ranges::find(words, text) != words.end();
    });
}

std::vector<std::string> split_list(std::string_view text) {
    std::vector<std::string> words;
    for (const std::string_view group : split(text, '+')) {
        for (const std::string_view word : split(group, ',')) words.emplace_back(word);
    }
    return words;
}

/// Recursive descent over the words of the text.
class Parser {
  public:
    explicit Parser(std::string_view text) : text_(text) { cut(); }

    NodePointer parse() {
        NodePointer node = parse_or(0);
        if (at_ < words_.size()) fail(fmt::format("'{}' was not expected here", words_[at_]));
        return node;
    }

  private:
    static constexpr int kDeepest = 100;

    [[noreturn]] void fail(std::string_view problem) const {
        throw UsageError(fmt::format(
            "'{}': {}; write for example 'chain A and not water' or 'resn HEM or resi 10-20'",
            text_, problem));
    }

    /// Brackets, operators and comparisons are words of their own.
    void cut() {
        std::string word;
        const auto flush = [&] {
            if (!word.empty()) words_.push_back(std::exchange(word, {}));
        };
        for (std::size_t i = 0; i < text_.size(); ++i) {
            const char c = text_[i];
            if (c == ' ' || c == '\t') {
                flush();
            } else if (std::string_view("()&|!<>=").find(c) != std::string_view::npos) {
                flush();
                word = c;
                const bool doubled = std::string_view("<>=").find(c) != std::string_view::npos &&
                                     i + 1 < text_.size() && text_[i + 1] == '=';
                if (doubled) word += text_[++i];
                flush();
            } else {
                word += c;
            }
        }
        flush();
    }

    std::string next_lower() const { return at_ < words_.size() ? to_lower(words_[at_]) : ""; }
    bool take(std::string_view word, std::string_view sign) {
        const std::string next = next_lower();
        if (next.empty() || (next != word && next != sign)) return false;
        ++at_;
        return true;
    }
    std::string take_any(std::string_view what) {
        if (at_ == words_.size()) fail(fmt::format("{} is missing at its end", what));
        return words_[at_++];
    }

    NodePointer parse_or(int depth) {
        NodePointer node = parse_and(depth);
        while (take("or", "|")) {
            node = pair_node(node, parse_and(depth), [](std::uint8_t a, std::uint8_t b) {
                return static_cast<std::uint8_t>(a | b);
            });
        }
        return node;
    }
    NodePointer parse_and(int depth) {
        NodePointer node = parse_not(depth);
        while (take("and", "&")) {
            node = pair_node(node, parse_not(depth), [](std::uint8_t a, std::uint8_t b) {
                return static_cast<std::uint8_t>(a & b);
            });
        }
        return node;
    }
    NodePointer parse_not(int depth) {
        if (depth > kDeepest) fail("is nested too deeply");
        if (take("not", "!")) return not_node(parse_not(depth + 1));
        if (take("(", "(")) {
            NodePointer node = parse_or(depth + 1);
            if (!take(")", ")")) fail("a closing bracket is missing");
            return node;
        }
        return parse_term();
    }

    NodePointer parse_term() {
        const std::string word = take_any("a word");
        const std::string lower = to_lower(word);
        if (at_ < words_.size()) {
            if (const auto comparison = find(kComparisons, words_[at_])) {
                return parse_comparison(word, *comparison);
            }
        }
        if (const auto test = find(kClasses, lower)) return atom_node(*test);
        if (const auto property = find(kProperties, lower)) return parse_property(*property, lower);
        std::vector<std::string_view> known;
        for (const auto& entry : kClasses) known.push_back(entry.first);
        for (const auto& entry : kProperties) known.push_back(entry.first);
        const std::string_view guess = closest(lower, known);
        fail(guess.empty()
                 ? fmt::format("'{}' is no word of a selection", word)
                 : fmt::format("'{}' is no word of a selection (did you mean {}?)", word, guess));
    }

    NodePointer parse_comparison(std::string field, Comparison comparison) {
        ++at_;
        const std::string number = take_any("a number");
        const std::optional<double> value = parse_double(number);
        if (!value) fail(fmt::format("'{}' is not a number", number));
        if (field == "b") field = "bfactor";  // as PyMOL says
        if (field == "q") field = "occupancy";
        return field_node(std::move(field), comparison, *value);
    }

    NodePointer parse_property(Property property, std::string_view name) {
        std::vector<std::string> words =
            split_list(take_any(fmt::format("what follows '{}'", name)));
        if (property == Property::residue_number) {
            std::vector<Range> ranges;
            for (const std::string& word : words) {
                const auto range = parse_range(word);
                if (!range) fail(fmt::format("'{}' is not a residue number or range", word));
                ranges.push_back(*range);
            }
            return number_node(std::move(ranges));
        }
        if (property == Property::element) {
            std::vector<std::uint8_t> numbers;
            for (const std::string& word : words) {
                const auto number = atomic_number(word);
                if (!number) fail(fmt::format("'{}' is not an element", word));
                numbers.push_back(*number);
            }
            return element_node(std::move(numbers));
        }
        return word_node(property, std::move(words));
    }

    std::string_view text_;
    std::vector<std::string> words_;
    std::size_t at_ = 0;
};

}  // namespace

Selection Selection::parse(std::string_view text) { return Selection(Parser(text).parse()); }

std::vector<std::uint8_t> Selection::evaluate(const Molecule& molecule) const {
    return root_->evaluate(molecule, root_->children);
}

}  // namespace ink
