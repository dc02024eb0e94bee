#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <system_error>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/openbabel_module.h"

namespace ink {

namespace {

// ---- The module ----

/// The functions of inktrace-openbabel.so, which stays loaded once it is.
struct OpenBabelModule {
    decltype(&inktrace_openbabel_read_mdl) read_mdl = nullptr;
    decltype(&inktrace_openbabel_free) free = nullptr;
};

constexpr std::string_view kModuleName = "inktrace-openbabel.so";

/// The folders of the running program and of the library that holds this code.
std::vector<std::filesystem::path> own_folders() {
    std::vector<std::filesystem::path> folders;
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) folders.push_back(program.parent_path());
    Dl_info info{};
    if (dladdr(&kModuleName, &info) != 0 && info.dli_fname != nullptr) {
        const auto library = std::filesystem::canonical(info.dli_fname, error);
        if (!error) folders.push_back(library.parent_path());
    }
    return folders;
}

std::vector<std::filesystem::path> module_folders() {
    std::vector<std::filesystem::path> folders;
    if (const char* chosen = std::getenv("INKTRACE_PLUGIN_DIR")) folders.emplace_back(chosen);
    for (const std::filesystem::path& own : own_folders()) {
        for (const char* relative : {"../lib", "../lib/inktrace", "inktrace", "."}) {
            folders.push_back((own / relative).lexically_normal());
        }
    }
    return folders;
}

/// The first module that there is; `error` says why none could be used.
void* open_module(std::string& error) {
    error = fmt::format("{} was not found", kModuleName);
    for (const std::filesystem::path& folder : module_folders()) {
        const std::filesystem::path module = folder / kModuleName;
        std::error_code ignored;
        if (!std::filesystem::exists(module, ignored)) continue;
        if (void* const handle = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL)) return handle;
        error = dlerror();
    }
    return nullptr;
}

OpenBabelModule load_module(const std::filesystem::path& file) {
    std::string error;
    void* const handle = open_module(error);
    if (handle == nullptr) {
        throw InputError(file, fmt::format("needs Open Babel, which cannot be loaded ({}); install "
                                           "it, or set INKTRACE_PLUGIN_DIR to the folder of {}",
                                           error, kModuleName));
    }
    OpenBabelModule module;
    module.read_mdl =
        reinterpret_cast<decltype(module.read_mdl)>(dlsym(handle, "inktrace_openbabel_read_mdl"));
    module.free = reinterpret_cast<decltype(module.free)>(dlsym(handle, "inktrace_openbabel_free"));
    if (module.read_mdl == nullptr || module.free == nullptr) {
        throw InputError(file, fmt::format("needs {}, and the one that was found is of another "
                                           "version; install it anew",
                                           kModuleName));
    }
    return module;
}

// ---- Records ----

/// One molecule of an SD file as it lies in the text.
struct SdfRecord {
    std::string_view text;
    std::size_t lines_before = 0;
};

/// Records end with a line "$$$$"; a MOL file is a single one without it. Returns how many there
/// are.
int find_record(std::string_view text, int wanted, SdfRecord& found) {
    int count = 0;
    std::string_view begin = text;
    std::size_t lines_before = 0;
    LineCursor lines(text);
    const auto close = [&] {
        const std::string_view record = begin.substr(0, begin.size() - lines.rest().size());
        const bool is_blank = trim(record).empty();
        if (!is_blank && count == wanted) found = {record, lines_before};
        if (!is_blank) ++count;
        begin = lines.rest();
        lines_before = lines.number();
    };
    while (lines.next()) {
        if (lines.line().starts_with("$$$$")) close();
    }
    close();
    return count;
}

// ---- Checks ----
// Open Babel takes a short counts line for an empty molecule, and spends minutes on the stereo
// centres of a sheet of 900 bonded atoms. So every line is checked here first, which also gives
// messages their place, and Open Babel gets a record of the atoms alone.

/// Checks one record line by line.
class RecordCheck {
  public:
    RecordCheck(const SdfRecord& record, const std::filesystem::path& file)
        : lines_(record.text), lines_before_(record.lines_before), file_(file) {}

    /// Throws InputError, or returns the record without its bonds and properties.
    std::string run() {
        for (int i = 0; i < 3; ++i) step("the header");
        step("the counts line");
        atoms_only_ = "\n\n\n";
        if (lines_.line().find("V3000") == std::string_view::npos) {
            check_v2000();
        } else {
            check_v3000();
        }
        return atoms_only_ + "M  END\n";
    }
    std::size_t atoms() const { return atoms_; }

  private:
    void check_v2000();
    void check_v2000_atom();
    void check_v2000_bond();

    void check_v3000();
    void check_v3000_atoms();
    void check_v3000_atom();
    void check_v3000_bonds(std::size_t bonds);
    void skip_to(std::string_view what);
    std::string next_v3000(std::string_view what);

    void step(std::string_view what) {
        if (lines_.next() && !lines_.line().starts_with("$$$$")) return;
        throw fail(
            fmt::format("the molecule ends inside {}; copy the file again if it was cut", what));
    }
    FilePlace place() const { return {file_, lines_before_ + lines_.number()}; }
    InputError fail(std::string_view problem) const { return {file_, place().line, problem}; }
    /// Columns `first` to `last` of the line, from 1, as the format's description counts them.
    std::string_view columns(std::size_t first, std::size_t last) const {
        const std::string_view line = lines_.line();
        if (line.size() < first) return {};
        return line.substr(first - 1, last - first + 1);
    }
    std::size_t count(std::string_view text, std::string_view of) const {
        const std::optional<std::int64_t> value = parse_int(text);
        if (value && *value >= 0) return static_cast<std::size_t>(*value);
        throw fail(fmt::format("expected the number of {}, found {}; repair the counts line", of,
                               excerpt(trim(text))));
    }

    LineCursor lines_;
    std::size_t lines_before_;
    const std::filesystem::path& file_;
    std::size_t atoms_ = 0;
    std::string atoms_only_;
    std::vector<std::int64_t> v3000_numbers_;  ///< of the atoms, sorted
};

void RecordCheck::check_v2000() {
    if (lines_.line().size() < 6) {
        throw fail(
            fmt::format("the counts line {} is too short; expected two numbers of three "
                        "columns each and V2000",
                        excerpt(lines_.line())));
    }
    atoms_ = count(columns(1, 3), "atoms");
    const std::size_t bonds = count(columns(4, 6), "bonds");
    atoms_only_ += fmt::format("{:3}  0  0  0  0  0  0  0  0  0999 V2000\n", atoms_);
    for (std::size_t i = 0; i < atoms_; ++i) {
        step("its atoms");
        check_v2000_atom();
    }
    for (std::size_t i = 0; i < bonds; ++i) {
        step("its bonds");
        check_v2000_bond();
    }
}

void RecordCheck::check_v2000_atom() {
    parse_position(columns(1, 10), columns(11, 20), columns(21, 30), place());
    const std::string_view symbol = trim(columns(32, 34));
    if (symbol.empty()) {
        throw fail("the atom has no element in columns 32 to 34; repair or remove the atom");
    }
    atoms_only_ += fmt::format("{} {:3} 0  0  0  0\n", columns(1, 30), symbol);
}

void RecordCheck::check_v2000_bond() {
    for (const std::string_view end : {columns(1, 3), columns(4, 6)}) {
        const std::int64_t atom = parse_int(end).value_or(0);
        if (atom >= 1 && static_cast<std::size_t>(atom) <= atoms_) continue;
        throw fail(
            fmt::format("the bond names atom {}, but there are {} atoms; repair or remove the bond",
                        excerpt(trim(end)), atoms_));
    }
}

/// The next line after "M  V30 ", with its continuation lines (a dash at the end) appended.
std::string RecordCheck::next_v3000(std::string_view what) {
    constexpr std::string_view kPrefix = "M  V30 ";
    std::string text;
    do {
        if (text.ends_with('-')) text.pop_back();
        step(what);
        const std::string_view line = lines_.line();
        if (!line.starts_with(kPrefix)) {
            throw fail(
                fmt::format("expected 'M  V30' inside {}, found {}; copy the file again if "
                            "it was cut",
                            what, excerpt(line)));
        }
        text += line.substr(kPrefix.size());
    } while (text.ends_with('-'));
    return text;
}

void RecordCheck::skip_to(std::string_view what) {
    while (!std::string_view(next_v3000("its V3000 table")).starts_with(what)) {
    }
}

void RecordCheck::check_v3000() {
    skip_to("BEGIN CTAB");
    const std::string text = next_v3000("the counts");
    std::string_view counts = text;
    if (take_word(counts) != "COUNTS") {
        throw fail(fmt::format("expected COUNTS, found {}; repair the V3000 table", excerpt(text)));
    }
    atoms_ = count(take_word(counts), "atoms");
    const std::size_t bonds = count(take_word(counts), "bonds");
    skip_to("BEGIN ATOM");
    check_v3000_atoms();
    if (bonds > 0) {
        skip_to("BEGIN BOND");
        check_v3000_bonds(bonds);
    }
}

void RecordCheck::check_v3000_atoms() {
    atoms_only_ += fmt::format(
        "  0  0  0  0  0  0  0  0  0  0999 V3000\n"
        "M  V30 BEGIN CTAB\nM  V30 COUNTS {} 0 0 0 0\n"
        "M  V30 BEGIN ATOM\n",
        atoms_);
    for (std::size_t i = 0; i < atoms_; ++i) check_v3000_atom();
    if (trim(next_v3000("its atoms")) != "END ATOM") {
        throw fail(fmt::format("expected END ATOM after {} atoms; repair the counts line", atoms_));
    }
    atoms_only_ += "M  V30 END ATOM\nM  V30 END CTAB\n";
    std::ranges::sort(v3000_numbers_);
}

void RecordCheck::check_v3000_atom() {
    const std::string text = next_v3000("its atoms");
    std::string_view rest = text;
    const std::optional<std::int64_t> number = parse_int(take_word(rest));
    const std::string_view symbol = take_word(rest);
    if (!number || *number < 1 || symbol.empty()) {
        throw fail(
            fmt::format("expected an atom (number, element, x, y, z), found {}; the "
                        "counts line announces {} atoms",
                        excerpt(text), atoms_));
    }
    const std::string_view x = take_word(rest);
    const std::string_view y = take_word(rest);
    const std::string_view z = take_word(rest);
    parse_position(x, y, z, place());
    v3000_numbers_.push_back(*number);
    atoms_only_ += fmt::format("M  V30 {} {} {} {} {} 0\n", v3000_numbers_.size(), symbol, x, y, z);
}

void RecordCheck::check_v3000_bonds(std::size_t bonds) {
    for (std::size_t i = 0; i < bonds; ++i) {
        const std::string text = next_v3000("its bonds");
        std::string_view rest = text;
        take_word(rest);
        take_word(rest);
        for (int end = 0; end < 2; ++end) {
            const std::string_view word = take_word(rest);
            if (std::ranges::binary_search(v3000_numbers_, parse_int(word).value_or(0))) continue;
            throw fail(
                fmt::format("the bond names atom {}, which the molecule does not have; "
                            "repair or remove the bond",
                            excerpt(word)));
        }
    }
}

// ---- Reading ----

using MoleculePointer =
    std::unique_ptr<InktraceOpenBabelMolecule, decltype(&inktrace_openbabel_free)>;

/// Open Babel's message on one line, without its decoration.
std::string one_line(std::string_view message) {
    std::string text;
    for (const std::string_view line : split(message, '\n')) {
        if (line.empty() || line.starts_with("=") || line.starts_with("***")) continue;
        if (!text.empty()) text += ' ';
        text += line;
    }
    return text;
}

MoleculePointer parse_record(const std::string& text, FilePlace place) {
    static const OpenBabelModule module = load_module(place.file);
    MoleculePointer molecule(module.read_mdl(text.data(), text.size(), "sdf"), module.free);
    if (molecule->error != nullptr) {
        throw InputError(
            place.file, place.line,
            fmt::format("{}; repair the file, or convert it anew", one_line(molecule->error)));
    }
    return molecule;
}

bool is_flat(const InktraceOpenBabelMolecule& molecule) {
    for (std::size_t i = 0; i < molecule.atom_count; ++i) {
        if (molecule.coordinates[3 * i + 2] != 0.0) return false;
    }
    return molecule.atom_count > 3;
}

FileContents build_contents(const InktraceOpenBabelMolecule& source, int frames,
                            const std::filesystem::path& file) {
    MoleculeBuilder molecule;
    molecule.reserve(source.atom_count);
    for (std::size_t i = 0; i < source.atom_count; ++i) {
        const double* const p = source.coordinates + 3 * i;
        molecule.add_atom({p[0], p[1], p[2]}, source.atomic_numbers[i]);
    }
    FileContents contents = std::move(molecule).finish(file, "SDF", frames);
    if (is_flat(source)) {
        contents.warnings.emplace_back(
            "All atoms have z = 0: the file seems to hold a flat drawing, not a 3D structure.");
    }
    return contents;
}

FileContents read_sdf(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    SdfRecord record;
    const int frames = find_record(text, options.frame, record);
    if (frames == 0) throw InputError(file, "is blank; is it an SDF file?");
    check_frame(options.frame, frames, file);
    RecordCheck check(record, file);
    const std::string atoms_only = check.run();
    const FilePlace place{file, record.lines_before + 1};
    const MoleculePointer molecule = parse_record(atoms_only, place);
    if (molecule->atom_count != check.atoms()) {
        throw InputError(
            file, place.line,
            fmt::format("announces {} atoms, but {} were found; repair the counts line",
                        check.atoms(), molecule->atom_count));
    }
    return build_contents(*molecule, frames, file);
}

constexpr std::array<std::string_view, 3> kExtensions{"sdf", "sd", "mol"};

}  // namespace

Reader sdf_reader() { return {"SDF", kExtensions, read_sdf}; }

}  // namespace ink
