#include "io/openbabel_module.h"

#include <dlfcn.h>
#include <openbabel/atom.h>
#include <openbabel/babelconfig.h>
#include <openbabel/mol.h>
#include <openbabel/obconversion.h>
#include <openbabel/oberror.h>
#include <openbabel/obiter.h>
#include <openbabel/plugin.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace {

struct OwnedMolecule : InktraceOpenBabelMolecule {
    std::vector<unsigned char> numbers;
    std::vector<double> xyz;
    std::string message;
};

/// Open Babel loads all of its hundred plugins when the first one is asked for (12 ms from a warm
/// disk cache, 75 ms from a cold one); the one that we need registers itself within a millisecond.
struct PluginLoading : OpenBabel::OBPlugin {
    static void load_only_mdl() {
        const char* const folder = std::getenv("BABEL_LIBDIR");
        const std::string plugin =
            std::string(folder != nullptr ? folder : OB_MODULE_PATH) + "/mdlformat.so";
        // Where it is not there, Open Babel looks for it in its own way.
        if (dlopen(plugin.c_str(), RTLD_NOW) != nullptr) AllPluginsLoaded = 1;
    }
};

OpenBabel::OBFormat* find_format(const char* name) {
    static const bool loaded = (PluginLoading::load_only_mdl(), true);
    static_cast<void>(loaded);
    return OpenBabel::OBConversion::FindFormat(name);
}

/// Keeps what Open Babel would print to stderr.
class CapturedLog {
  public:
    CapturedLog() : previous_(OpenBabel::obErrorLog.GetOutputStream()) {
        OpenBabel::obErrorLog.SetOutputStream(&text_);
    }
    CapturedLog(const CapturedLog&) = delete;
    CapturedLog& operator=(const CapturedLog&) = delete;
    ~CapturedLog() { OpenBabel::obErrorLog.SetOutputStream(previous_); }

    std::string text() const { return text_.str(); }

  private:
    std::ostringstream text_;
    std::ostream* previous_;
};

void read_mdl(OwnedMolecule& out, const std::string& text, const char* format_name) {
    OpenBabel::OBFormat* const format = find_format(format_name);
    if (format == nullptr) {
        out.message = "Open Babel has no reader for this format";
        return;
    }
    const CapturedLog log;
    std::istringstream in(text);
    OpenBabel::OBConversion conversion(&in);
    OpenBabel::OBMol molecule;
    if (!conversion.SetInFormat(format) || !conversion.Read(&molecule)) {
        out.message = "Open Babel cannot read it: " + log.text();
        return;
    }
    FOR_ATOMS_OF_MOL(atom, molecule) {
        out.numbers.push_back(static_cast<unsigned char>(atom->GetAtomicNum()));
        out.xyz.insert(out.xyz.end(), {atom->GetX(), atom->GetY(), atom->GetZ()});
    }
}

}  // namespace

InktraceOpenBabelMolecule* inktrace_openbabel_read_mdl(const char* text, std::size_t size,
                                                       const char* format) {
    auto out = std::make_unique<OwnedMolecule>();
    try {
        read_mdl(*out, std::string(text, size), format);
    } catch (const std::exception& error) {
        out->message = error.what();
    }
    out->atom_count = out->numbers.size();
    out->atomic_numbers = out->numbers.data();
    out->coordinates = out->xyz.data();
    out->error = out->message.empty() ? nullptr : out->message.c_str();
    return out.release();
}

void inktrace_openbabel_free(InktraceOpenBabelMolecule* molecule) {
    delete static_cast<OwnedMolecule*>(molecule);
}
