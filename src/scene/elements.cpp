#include "scene/elements.h"

#include <algorithm>
#include <array>

#include "base/text.h"

namespace ink {

namespace {

// Van der Waals radii: the main group (groups 1, 2 and 13 to 18) is Table 12 of Mantina et al.,
// J. Phys. Chem. A 2009, 113, 5806, which keeps most of Bondi's values of 1964. The d and f block
// is the element data of Open Babel 3.1.1; its Sc to Zn and Y to Cd are the crystallographic radii
// of Batsanov, Inorg. Mater. 2001, 37, 871, and its 2.00 from element 93 on (and for Ac, Pa) is a
// placeholder, not a measurement. Open Babel's values for In, Sn and Sb are not those of Mantina
// (each seems to have slipped by one element) and are not used.
//
// Colours: Jmol's defaults, http://jmol.sourceforge.net/jscolors; they end at 109 (Mt), whose
// colour stands for the heavier elements.
constexpr std::array<Element, kElementCount> kElements{{
    {"Xx", 1.50f, {255, 20, 147}},  {"H", 1.10f, {255, 255, 255}},  {"He", 1.40f, {217, 255, 255}},
    {"Li", 1.81f, {204, 128, 255}}, {"Be", 1.53f, {194, 255, 0}},   {"B", 1.92f, {255, 181, 181}},
    {"C", 1.70f, {144, 144, 144}},  {"N", 1.55f, {48, 80, 248}},    {"O", 1.52f, {255, 13, 13}},
    {"F", 1.47f, {144, 224, 80}},   {"Ne", 1.54f, {179, 227, 245}}, {"Na", 2.27f, {171, 92, 242}},
    {"Mg", 1.73f, {138, 255, 0}},   {"Al", 1.84f, {191, 166, 166}}, {"Si", 2.10f, {240, 200, 160}},
    {"P", 1.80f, {255, 128, 0}},    {"S", 1.80f, {255, 255, 48}},   {"Cl", 1.75f, {31, 240, 31}},
    {"Ar", 1.88f, {128, 209, 227}}, {"K", 2.75f, {143, 64, 212}},   {"Ca", 2.31f, {61, 255, 0}},
    {"Sc", 2.30f, {230, 230, 230}}, {"Ti", 2.15f, {191, 194, 199}}, {"V", 2.05f, {166, 166, 171}},
    {"Cr", 2.05f, {138, 153, 199}}, {"Mn", 2.05f, {156, 122, 199}}, {"Fe", 2.05f, {224, 102, 51}},
    {"Co", 2.00f, {240, 144, 160}}, {"Ni", 2.00f, {80, 208, 80}},   {"Cu", 2.00f, {200, 128, 51}},
    {"Zn", 2.10f, {125, 128, 176}}, {"Ga", 1.87f, {194, 143, 143}}, {"Ge", 2.11f, {102, 143, 143}},
    {"As", 1.85f, {189, 128, 227}}, {"Se", 1.90f, {255, 161, 0}},   {"Br", 1.83f, {166, 41, 41}},
    {"Kr", 2.02f, {92, 184, 209}},  {"Rb", 3.03f, {112, 46, 176}},  {"Sr", 2.49f, {0, 255, 0}},
    {"Y", 2.40f, {148, 255, 255}},  {"Zr", 2.30f, {148, 224, 224}}, {"Nb", 2.15f, {115, 194, 201}},
    {"Mo", 2.10f, {84, 181, 181}},  {"Tc", 2.05f, {59, 158, 158}},  {"Ru", 2.05f, {36, 143, 143}},
    {"Rh", 2.00f, {10, 125, 140}},  {"Pd", 2.05f, {0, 105, 133}},   {"Ag", 2.10f, {192, 192, 192}},
    {"Cd", 2.20f, {255, 217, 143}}, {"In", 1.93f, {166, 117, 115}}, {"Sn", 2.17f, {102, 128, 128}},
    {"Sb", 2.06f, {158, 99, 181}},  {"Te", 2.06f, {212, 122, 0}},   {"I", 1.98f, {148, 0, 148}},
    {"Xe", 2.16f, {66, 158, 176}},  {"Cs", 3.43f, {87, 23, 143}},   {"Ba", 2.68f, {0, 201, 0}},
    {"La", 2.50f, {112, 212, 255}}, {"Ce", 2.48f, {255, 255, 199}}, {"Pr", 2.47f, {217, 255, 199}},
    {"Nd", 2.45f, {199, 255, 199}}, {"Pm", 2.43f, {163, 255, 199}}, {"Sm", 2.42f, {143, 255, 199}},
    {"Eu", 2.40f, {97, 255, 199}},  {"Gd", 2.38f, {69, 255, 199}},  {"Tb", 2.37f, {48, 255, 199}},
    {"Dy", 2.35f, {31, 255, 199}},  {"Ho", 2.33f, {0, 255, 156}},   {"Er", 2.32f, {0, 230, 117}},
    {"Tm", 2.30f, {0, 212, 82}},    {"Yb", 2.28f, {0, 191, 56}},    {"Lu", 2.27f, {0, 171, 36}},
    {"Hf", 2.25f, {77, 194, 255}},  {"Ta", 2.20f, {77, 166, 255}},  {"W", 2.10f, {33, 148, 214}},
    {"Re", 2.05f, {38, 125, 171}},  {"Os", 2.00f, {38, 102, 150}},  {"Ir", 2.00f, {23, 84, 135}},
    {"Pt", 2.05f, {208, 208, 224}}, {"Au", 2.10f, {255, 209, 35}},  {"Hg", 2.05f, {184, 184, 208}},
    {"Tl", 1.96f, {166, 84, 77}},   {"Pb", 2.02f, {87, 89, 97}},    {"Bi", 2.07f, {158, 79, 181}},
    {"Po", 1.97f, {171, 92, 0}},    {"At", 2.02f, {117, 79, 69}},   {"Rn", 2.20f, {66, 130, 150}},
    {"Fr", 3.48f, {66, 0, 102}},    {"Ra", 2.83f, {0, 125, 0}},     {"Ac", 2.00f, {112, 171, 250}},
    {"Th", 2.40f, {0, 186, 255}},   {"Pa", 2.00f, {0, 161, 255}},   {"U", 2.30f, {0, 143, 255}},
    {"Np", 2.00f, {0, 128, 255}},   {"Pu", 2.00f, {0, 107, 255}},   {"Am", 2.00f, {84, 92, 242}},
    {"Cm", 2.00f, {120, 92, 227}},  {"Bk", 2.00f, {138, 79, 227}},  {"Cf", 2.00f, {161, 54, 212}},
    {"Es", 2.00f, {179, 31, 212}},  {"Fm", 2.00f, {179, 31, 186}},  {"Md", 2.00f, {179, 13, 166}},
    {"No", 2.00f, {189, 13, 135}},  {"Lr", 2.00f, {199, 0, 102}},   {"Rf", 2.00f, {204, 0, 89}},
    {"Db", 2.00f, {209, 0, 79}},    {"Sg", 2.00f, {217, 0, 69}},    {"Bh", 2.00f, {224, 0, 56}},
    {"Hs", 2.00f, {230, 0, 46}},    {"Mt", 2.00f, {235, 0, 38}},    {"Ds", 2.00f, {235, 0, 38}},
    {"Rg", 2.00f, {235, 0, 38}},    {"Cn", 2.00f, {235, 0, 38}},    {"Nh", 2.00f, {235, 0, 38}},
    {"Fl", 2.00f, {235, 0, 38}},    {"Mc", 2.00f, {235, 0, 38}},    {"Lv", 2.00f, {235, 0, 38}},
    {"Ts", 2.00f, {235, 0, 38}},    {"Og", 2.00f, {235, 0, 38}},
}};

// Cordero et al., Dalton Trans. 2008, 2832 (C: sp3; Mn, Fe, Co: low spin), from the unknown
// element, which has the radius of half a carbon bond, to curium. Heavier ones take curium's.
constexpr auto kCovalentRadii = std::to_array<float>(
    {0.77f, 0.31f, 0.28f, 1.28f, 0.96f, 0.84f, 0.76f, 0.71f, 0.66f, 0.57f, 0.58f, 1.66f, 1.41f,
     1.21f, 1.11f, 1.07f, 1.05f, 1.02f, 1.06f, 2.03f, 1.76f, 1.70f, 1.60f, 1.53f, 1.39f, 1.39f,
     1.32f, 1.26f, 1.24f, 1.32f, 1.22f, 1.22f, 1.20f, 1.19f, 1.20f, 1.20f, 1.16f, 2.20f, 1.95f,
     1.90f, 1.75f, 1.64f, 1.54f, 1.47f, 1.46f, 1.42f, 1.39f, 1.45f, 1.44f, 1.42f, 1.39f, 1.39f,
     1.38f, 1.39f, 1.40f, 2.44f, 2.15f, 2.07f, 2.04f, 2.03f, 2.01f, 1.99f, 1.98f, 1.98f, 1.96f,
     1.94f, 1.92f, 1.92f, 1.89f, 1.90f, 1.87f, 1.87f, 1.75f, 1.70f, 1.62f, 1.51f, 1.44f, 1.41f,
     1.36f, 1.36f, 1.32f, 1.45f, 1.46f, 1.48f, 1.40f, 1.50f, 1.50f, 2.60f, 2.21f, 2.15f, 2.06f,
     2.00f, 1.96f, 1.90f, 1.87f, 1.80f, 1.69f});

struct BondiRadius {
    std::string_view symbol;
    float radius;
};

// Bondi, J. Phys. Chem. 1964, 68, 441, tables I and II, where they differ from the table above.
constexpr auto kBondiRadii = std::to_array<BondiRadius>({{"H", 1.20f},
                                                         {"Li", 1.82f},
                                                         {"Ni", 1.63f},
                                                         {"Cu", 1.40f},
                                                         {"Zn", 1.39f},
                                                         {"Br", 1.85f},
                                                         {"Pd", 1.63f},
                                                         {"Ag", 1.72f},
                                                         {"Cd", 1.58f},
                                                         {"Pt", 1.72f},
                                                         {"Au", 1.66f},
                                                         {"Hg", 1.55f},
                                                         {"U", 1.86f}});

float bondi_radius(const Element& kind) {
    for (const BondiRadius& entry : kBondiRadii) {
        if (entry.symbol == kind.symbol) return entry.radius;
    }
    return kind.vdw_radius;
}

constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Symbols have one or two letters; a table by both of them makes the lookup one step, which
/// matters for files with millions of atoms.
constexpr std::size_t slot(char first, char second) {
    return static_cast<std::size_t>(first - 'A') * 27 +
           static_cast<std::size_t>(second == '\0' ? 0 : second - 'A' + 1);
}

constexpr std::array<std::uint8_t, std::size_t{26}* 27> kNumberBySlot = [] {
    std::array<std::uint8_t, std::size_t{26} * 27> numbers{};
    for (std::size_t z = 1; z < kElementCount; ++z) {
        const std::string_view symbol = kElements[z].symbol;
        numbers[slot(symbol[0], symbol.size() > 1 ? upper(symbol[1]) : '\0')] =
            static_cast<std::uint8_t>(z);
    }
    numbers[slot('D', '\0')] = 1;
    numbers[slot('T', '\0')] = 1;
    return numbers;
}();

constexpr bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

const Element& element(std::uint8_t atomic_number) {
    return kElements[atomic_number < kElementCount ? atomic_number : 0];
}

float atom_radius(RadiiTable table, std::uint8_t atomic_number) {
    const Element& kind = element(atomic_number);
    if (table == RadiiTable::bondi) return bondi_radius(kind);
    if (table == RadiiTable::vdw) return kind.vdw_radius;
    return kCovalentRadii[std::min<std::size_t>(atomic_number, kCovalentRadii.size() - 1)];
}

std::optional<std::uint8_t> atomic_number(std::string_view symbol) {
    symbol = trim(symbol);
    if (symbol.empty() || symbol.size() > 2) return std::nullopt;
    const char first = upper(symbol[0]);
    const char second = symbol.size() > 1 ? upper(symbol[1]) : '\0';
    if (!is_letter(first) || (second != '\0' && !is_letter(second))) return std::nullopt;
    const std::uint8_t number = kNumberBySlot[slot(first, second)];
    if (number == 0) return std::nullopt;
    return number;
}

}  // namespace ink
