#include "io/cif_grammar.h"

#include <gemmi/cif.hpp>

namespace ink {

namespace {

namespace rules = gemmi::cif::rules;

struct Walk {
    CifVisitor& visitor;
    std::string_view tag;  ///< of the item whose value follows
};

template <class Rule>
struct Action : tao::pegtl::nothing<Rule> {};

template <>
struct Action<rules::datablockheading> {
    static void apply0(Walk& walk) { walk.visitor.begin_block(); }
};
template <>
struct Action<rules::item_tag> {
    template <class Input>
    static void apply(const Input& in, Walk& walk) {
        walk.tag = in.string_view();
    }
};
template <>
struct Action<rules::item_value> {
    template <class Input>
    static void apply(const Input& in, Walk& walk) {
        walk.visitor.add_item(walk.tag, in.string_view(), in.iterator().line);
    }
};
template <>
struct Action<rules::str_loop> {
    static void apply0(Walk& walk) { walk.visitor.begin_loop(); }
};
template <>
struct Action<rules::loop_tag> {
    template <class Input>
    static void apply(const Input& in, Walk& walk) {
        walk.visitor.add_tag(in.string_view());
    }
};
template <>
struct Action<rules::loop_value> {
    template <class Input>
    static void apply(const Input& in, Walk& walk) {
        walk.visitor.add_value(in.string_view(), in.iterator().line);
    }
};
template <>
struct Action<rules::loop> {
    static void apply0(Walk& walk) { walk.visitor.end_loop(); }
};

}  // namespace

void walk_cif(std::string_view text, CifVisitor& visitor) {
    try {
        Walk state{visitor, {}};
        tao::pegtl::memory_input<> input(text.data(), text.size(), "");
        tao::pegtl::parse<rules::file, Action, gemmi::cif::Errors>(input, state);
    } catch (const tao::pegtl::parse_error& error) {
        throw CifSyntaxError(std::string(error.message()), error.positions().front().line);
    }
}

}  // namespace ink
