// Prints what is in the clipboard, for viewer_test.sh.

#include <GLFW/glfw3.h>

#include <cstdio>

int main() {
    if (glfwInit() == GLFW_FALSE) return 1;
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    // Without OpenGL: its drivers leave leaks behind when they are unloaded.
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow* const window = glfwCreateWindow(8, 8, "clipboard", nullptr, nullptr);
    const char* const text = window == nullptr ? nullptr : glfwGetClipboardString(window);
    if (text != nullptr) std::puts(text);
    glfwTerminate();
    return text == nullptr ? 1 : 0;
}
