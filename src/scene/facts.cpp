#include "scene/facts.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "scene/elements.h"
#include "scene/molecule.h"
#include "scene/scene.h"

namespace ink {

namespace {

void add_fields(const std::vector<Field>& fields, std::size_t entry, Facts& facts) {
    for (const Field& field : fields) {
        const std::size_t first = entry * field.components;
        if (first + field.components > field.values.size()) continue;
        std::string text;
        for (std::size_t c = 0; c < field.components; ++c) {
            const float value = field.values[first + c];
            text += c == 0 ? "" : ", ";
            text += field.words.empty() || !std::isfinite(value)
                        ? fmt::format("{:.6g}", value)
                        : field.words[static_cast<std::size_t>(value)];
        }
        facts.emplace_back(field.name, std::move(text));
    }
}

Facts facts_of(const Molecule& m, std::size_t atom) {
    Facts facts;
    if (atom >= m.atom_count()) return facts;
    if (atom < m.atom_names.size()) facts.emplace_back("name", to_text(m.atom_names[atom]));
    facts.emplace_back("element", element(m.elements[atom]).symbol);
    if (const Residue* residue = m.residue(atom)) {
        facts.emplace_back("residue", fmt::format("{} {}", residue->name, residue->number));
        if (residue->chain < m.chains.size() && !m.chains[residue->chain].empty()) {
            const std::size_t copy = m.copy_numbers.empty() ? 0 : m.copy_numbers[atom];
            facts.emplace_back("chain", m.chains[residue->chain] + copy_suffix(copy));
        }
    }
    add_fields(m.fields, atom, facts);
    return facts;
}

}  // namespace

std::vector<FactSource> molecule_facts(Molecule molecule) {
    const auto kept = std::make_shared<const Molecule>(std::move(molecule));
    if (kept->units.empty()) {
        return {[kept](std::uint32_t atom) { return facts_of(*kept, atom); }};
    }
    std::vector<FactSource> sources;
    for (const Unit& unit : kept->units) {
        sources.emplace_back([kept, first = unit.first](std::uint32_t atom) {
            return facts_of(*kept, first + atom);
        });
    }
    return sources;
}

FactSource field_facts(std::vector<Field> fields, std::vector<std::uint32_t> rows) {
    struct Table {
        std::vector<Field> fields;
        std::vector<std::uint32_t> rows;
    };
    const auto kept = std::make_shared<const Table>(Table{std::move(fields), std::move(rows)});
    return [kept](std::uint32_t primitive) {
        Facts facts;
        if (!kept->rows.empty() && primitive >= kept->rows.size()) return facts;
        add_fields(kept->fields, kept->rows.empty() ? primitive : kept->rows[primitive], facts);
        return facts;
    };
}

}  // namespace ink
