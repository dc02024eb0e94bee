// PQR, as PDB2PQR writes it: PDB's atom records, cut at blanks, with charge and radius at the end.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"

namespace ink {

namespace {

constexpr std::array<std::string_view, 1> kFields{"charge"};

class PqrReader {
  public:
    explicit PqrReader(const std::filesystem::path& file) : file_(file) {
        molecule_.set_fields(kFields);
    }

    void read(std::string_view text) {
        LineCursor lines(text);
        while (lines.next()) {
            if (lines.line().starts_with("ATOM") || lines.line().starts_with("HETATM")) {
                read_atom(lines.line(), {file_, lines.number()});
            }
        }
    }
    MoleculeBuilder& molecule() { return molecule_; }

  private:
    void read_atom(std::string_view line, FilePlace place) {
        words_.clear();
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
            words_.push_back(word);
        }
        // ATOM serial name residue [chain] number x y z charge radius
        constexpr std::size_t kFewest = 10;
        if (words_.size() < kFewest) {
            throw InputError(place.file, place.line,
                             fmt::format("the atom has {} of at least {} columns; repair or remove "
                                         "it",
                                         words_.size(), kFewest));
        }
        const bool has_chain = words_.size() > kFewest;
        const std::size_t x = has_chain ? 6 : 5;
        const Vec3d position = parse_position(words_[x], words_[x + 1], words_[x + 2], place);
        enter_residue(has_chain ? words_[4] : std::string_view(), words_[3], words_[x - 1]);
        molecule_.add_atom(position, element_of_name(words_[2], words_[3]), words_[2]);
        molecule_.set_value(0, number(words_[x + 3], "charge", place));
        const double radius = number(words_[x + 4], "radius", place);
        if (radius < 0.0) {
            throw InputError(place.file, place.line, "the radius is negative; repair the atom");
        }
        molecule_.set_radius(radius);
    }

    static double number(std::string_view word, std::string_view what, FilePlace place) {
        const std::optional<double> value = parse_double(word);
        if (value && std::abs(*value) <= kLargestCoordinate) return *value;
        throw InputError(
            place.file, place.line,
            fmt::format("the {} {} is not a number; repair the atom", what, excerpt(word)));
    }

    void enter_residue(std::string_view chain, std::string_view name, std::string_view number) {
        if (!molecule_.empty() && chain == chain_ && name == name_ && number == number_) return;
        chain_ = chain;
        name_ = name;
        number_ = number;
        molecule_.begin_residue(chain, name,
                                static_cast<std::int32_t>(parse_int(number).value_or(0)));
    }

    const std::filesystem::path& file_;
    MoleculeBuilder molecule_;
    std::vector<std::string_view> words_;
    std::string_view chain_, name_, number_;  ///< of the residue
};

FileContents read_pqr(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    check_frame(options.frame, 1, file);
    PqrReader reader(file);
    reader.read(text);
    return std::move(reader.molecule()).finish(file, "PQR", 1, options);
}

constexpr std::array<std::string_view, 1> kExtensions{"pqr"};

}  // namespace

Reader pqr_reader() { return {"PQR", kExtensions, read_pqr}; }

}  // namespace ink
