// Writes a small valid file of every format: make_seeds FOLDER makes FOLDER/pdb/a.pdb and so on.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace {

struct Seed {
    std::string_view format;
    std::string content;
};

template <class T>
std::string raw(T value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    return {bytes.data(), bytes.size()};
}

std::string binary_stl() {
    std::string bytes(80, ' ');
    bytes += raw(std::uint32_t{1});
    for (const float x : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F})
        bytes += raw(x);
    return bytes + std::string(2, '\0');
}

std::string raw_vtp() {
    std::string text =
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData>"
        "<Piece NumberOfPoints=\"1\"><PointData><DataArray type=\"Float32\" Name=\"radius\" "
        "format=\"appended\" offset=\"0\"/></PointData><Points><DataArray type=\"Float32\" "
        "NumberOfComponents=\"3\" format=\"appended\" offset=\"8\"/></Points></Piece></PolyData>"
        "<AppendedData encoding=\"raw\">_";
    text +=
        raw(std::uint32_t{4}) + raw(1.F) + raw(std::uint32_t{12}) + raw(0.F) + raw(1.F) + raw(2.F);
    return text + "</AppendedData></VTKFile>";
}

/// A number with its most significant byte first.
template <class T>
std::string big_endian(T value) {
    std::string bytes = raw(value);
    if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(bytes);
    return bytes;
}

std::string bgeo() {
    std::string bytes("BgeoV");
    for (const std::int32_t count : {5, 1, 0, 0, 0, 2, 0, 0, 0}) bytes += big_endian(count);
    const auto begin_attribute = [&](std::string_view name, std::int16_t size, std::int32_t type) {
        bytes += big_endian(static_cast<std::int16_t>(name.size())) + std::string(name);
        bytes += big_endian(size) + big_endian(type);
    };
    begin_attribute("Cd", 3, 0);
    for (int k = 0; k < 3; ++k) bytes += big_endian(1.F);
    begin_attribute("s", 1, 4);
    bytes += big_endian(std::int32_t{1}) + big_endian(std::int16_t{1}) + "a";
    for (const float x : {1.F, 2.F, 3.F, 1.F, 0.5F, 0.25F, 0.F}) bytes += big_endian(x);
    return bytes + big_endian(std::int32_t{0});
}

std::string glb() {
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,)"
        R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string data;
    for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) data += raw(x);
    const auto size = static_cast<std::uint32_t>(28 + json.size() + data.size());
    std::string bytes("glTF");
    bytes += raw(std::uint32_t{2}) + raw(size) + raw(static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json + raw(static_cast<std::uint32_t>(data.size()));
    bytes += std::string_view("BIN\0", 4);
    return bytes + data;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: make_seeds FOLDER\n", stderr);
        return 2;
    }
    const std::array seeds{
        Seed{
            "pdb",
            "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
            "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
            "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
            "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\nMODEL        1\n"
            "ATOM      1  CA AALA A   1       1.000   2.000   3.000  1.00 10.00           C\n"
            "HETATM    2 ZN    ZN A   2       4.000   5.000   6.000  1.00 20.00          ZN\n"
            "ENDMDL\nEND\n"},
        Seed{"cif",
             "data_x\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n"
             "_pdbx_struct_assembly_gen.oper_expression\n_pdbx_struct_assembly_gen.asym_id_list\n"
             "1 '(1-2)(X)' A,B\nloop_\n_atom_site.type_symbol\n_atom_site.label_asym_id\n"
             "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\nC A 1 2 3.0(1)\n"},
        Seed{"cif",
             "data_x\n_cell_length_a 10\n_cell_length_b 9\n_cell_length_c 8\n_cell_angle_alpha 90\n"
             "_cell_angle_beta 100\n_cell_angle_gamma 90\nloop_\n_atom_site_label\n"
             "_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nC1 0.1 0.2 0.3\n"},
        Seed{"sdf",
             "x\n\n\n  2  1  0  0  0  0  0  0  0  0999 V2000\n"
             "    0.0000    0.0000    0.0000 C   0  0\n    1.2000    0.0000    0.0000 O   0  0\n"
             "  1  2  2  0\nM  END\n$$$$\n"},
        Seed{"mol2",
             "@<TRIPOS>MOLECULE\nx\n2 1\nSMALL\nX\n@<TRIPOS>ATOM\n1 C1 0 0 0 C.3 1 RES 0.1\n"
             "2 O1 1 0 0 O.2 1 RES -0.1\n@<TRIPOS>BOND\n1 1 2 2\n"},
        Seed{"xyz", "2\nProperties=species:S:1:pos:R:3:radius:R:1\nC 0 0 0 1\nO 1 0 0 0.5\n"},
        Seed{"gro", "t\n1\n    1ALA     CA    1   0.100   0.200   0.300\n1 1 1\n"},
        Seed{"pqr", "ATOM 1 CA ALA A 1 1 2 3 -0.1 1.5\nTER\n"},
        Seed{"csv", "x,y,z,radius\n0,0,0,1\n1,2,3,0.5\n"},
        Seed{"txt", "2\n0 0 0\n1 2 3\n"},
        Seed{"dump",
             "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz pp pp pp\n"
             "0 3 1\n0 2 0\n0 2 0\nITEM: ATOMS id xs ys zs radius\n1 0 0 0 1\n2 0.5 0.5 1 0.5\n"},
        Seed{"vtp", raw_vtp()},
        Seed{"vtu",
             "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"1\">"
             "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3"
             "</DataArray></Points></Piece></UnstructuredGrid></VTKFile>"},
        Seed{
            "vtp",
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\" "
            "NumberOfStrips=\"1\"><PointData><DataArray type=\"Float32\" Name=\"t\" "
            "format=\"ascii\">0 1 2 3</DataArray></PointData><Points><DataArray type=\"Float64\" "
            "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>"
            "<Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3"
            "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
            "</Polys><Strips><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">"
            "0 1 3 2</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4"
            "</DataArray></Strips></Piece></PolyData></VTKFile>"},
        Seed{"vtu",
             "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" "
             "NumberOfCells=\"3\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
             "format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 0</DataArray></Points><Cells><DataArray "
             "type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 1 2 3 0 1 3 2"
             "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 7 11"
             "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 8 "
             "9</DataArray>"
             "</Cells></Piece></UnstructuredGrid></VTKFile>"},
        Seed{"bgeo", bgeo()},
        Seed{"obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\ng a\nf 1//1 2//1 3//1 -1//1\n"},
        Seed{"off", "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n"},
        Seed{"glb", glb()},
        Seed{
            "ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        Seed{"ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nproperty float radius\nend_header\n0 0 0 1\n"},
        Seed{"stl", binary_stl()},
        Seed{"stl",
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
             "endloop\nendfacet\nendsolid a\n"}};
    int number = 0;
    for (const Seed& seed : seeds) {
        const std::filesystem::path folder = std::filesystem::path(argv[1]) / seed.format;
        std::filesystem::create_directories(folder);
        std::ofstream(folder / std::to_string(++number), std::ios::binary) << seed.content;
    }
    return 0;
}
