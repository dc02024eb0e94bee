#include "io/cif_grammar.h"

#include <gemmi/cif.hpp>

namespace ink {

namespace {

namespace rules = gemmi::cif::rules;

template <class Rule>
struct LoopAction : tao::pegtl::nothing<Rule> {};

template <>
struct LoopAction<rules::str_loop> {
    static void apply0(CifLoops& loops) { loops.begin_loop(); }
};
template <>
struct LoopAction<rules::loop_tag> {
    template <class Input>
    static void apply(const Input& in, CifLoops& loops) {
        loops.add_tag(in.string_view());
    }
};
template <>
struct LoopAction<rules::loop_value> {
    template <class Input>
    static void apply(const Input& in, CifLoops& loops) {
        loops.add_value(in.string_view(), in.iterator().line);
    }
};
template <>
struct LoopAction<rules::loop> {
    static void apply0(CifLoops& loops) { loops.end_loop(); }
};

}  // namespace

void walk_cif(std::string_view text, CifLoops& loops) {
    try {
        tao::pegtl::memory_input<> input(text.data(), text.size(), "");
        tao::pegtl::parse<rules::file, LoopAction, gemmi::cif::Errors>(input, loops);
    } catch (const tao::pegtl::parse_error& error) {
        throw CifSyntaxError(std::string(error.message()), error.positions().front().line);
    }
}

}  // namespace ink
