#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scene/field.h"

namespace ink {

struct Molecule;

/// What a file says about one atom or particle, in words: ("residue", "ALA 12").
using Facts = std::vector<std::pair<std::string, std::string>>;
/// Of a primitive, by its index in its object.
using FactSource = std::function<Facts(std::uint32_t primitive)>;

/// Of a molecule's atoms, a source for each of its units, by their index in it.
std::vector<FactSource> molecule_facts(Molecule molecule);

/// Of particles: the values of fields. `rows[k]` is the entry of primitive k; empty: k itself.
FactSource field_facts(std::vector<Field> fields, std::vector<std::uint32_t> rows);

}  // namespace ink
