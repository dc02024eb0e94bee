// Draws a molecule with soft lines: draw_molecule acetaminophen.xyz picture.png
//
// Or as picture.exr, picture.svg, ...: the name tells what the file needs.

#include <inktrace/inktrace.h>

#include <iostream>

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::cerr << "usage: draw_molecule INPUT OUTPUT\n";
        return 2;
    }

    inktrace::Scene scene;
    const inktrace::FileInfo info = scene.load(argv[1]);
    std::cout << info.format << ", " << scene.primitive_count() << " primitives\n";

    inktrace::Settings settings;
    settings.set("size", "640x480").set("line-width", "3px").set("metric", "power:10");

    const inktrace::Renderer renderer(std::move(scene));
    const inktrace::RenderOptions options = inktrace::options_for_output(argv[2]);
    const inktrace::Picture picture = renderer.render(settings, options);
    picture.save(argv[2]);
    std::cout << argv[2] << ": " << picture.stats().render_ms << " ms\n";
    return 0;
} catch (const inktrace::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
