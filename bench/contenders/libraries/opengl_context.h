// The context that opengl.cpp draws in, without a window: on the first device that EGL lists and that is not software,
// else in software. And objects of OpenGL that delete themselves.
#pragma once

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace umbra_opengl {

inline GLuint program_of(std::initializer_list<std::tuple<GLenum, std::string>> shaders) {
    const GLuint program = glCreateProgram();
    for (const auto& [stage, text] : shaders) {
        const GLuint shader = glCreateShader(stage);
        const char* source  = text.c_str();
        glShaderSource(shader, 1, &source, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != 0) return program;
    std::array<char, 200> log{};
    glGetProgramInfoLog(program, log.size(), nullptr, log.data());
    throw std::runtime_error("OpenGL refuses a program: " + std::string(log.data()));
}

inline GLuint sampler_of(GLint filtering) {
    constexpr std::array kOne{1.f, 1.f, 1.f, 1.f};  // outside of the map: lit
    GLuint sampler = 0;
    glCreateSamplers(1, &sampler);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glSamplerParameteri(sampler, filter, filtering);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glSamplerParameteri(sampler, wrap, GL_CLAMP_TO_BORDER);
    glSamplerParameterfv(sampler, GL_TEXTURE_BORDER_COLOR, kOne.data());
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    return sampler;
}

/// The one context of the process, and the samplers.
class Context {
public:
    std::string fault, release = "without a context";
    GLuint linear = 0, nearest = 0;  ///< samplers that compare

    Context() {
        const auto device_extension = [](EGLDeviceEXT device, const char* name) {
            const char* all = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
            return all != nullptr && std::string_view(all).find(name) != std::string_view::npos;
        };
        fault = "no EGL display without a window has OpenGL 4.5";
        if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
            std::array<EGLDeviceEXT, 16> devices{};
            EGLint count = 0;
            if (eglQueryDevicesEXT(devices.size(), devices.data(), &count) == EGL_FALSE) count = 0;
            for (EGLint i = 0; i < count && context_ == EGL_NO_CONTEXT; ++i)
                if (!device_extension(devices[i], "EGL_MESA_device_software"))
                    open(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        }
        if (context_ == EGL_NO_CONTEXT && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
            open(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
        if (context_ == EGL_NO_CONTEXT) return;
        try {
            prepare();
            fault.clear();
        } catch (const std::exception& e) {
            fault = e.what();
        }
        leave();
    }

    void enter() const {
        eglBindAPI(EGL_OPENGL_API);
        if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
            throw std::runtime_error("EGL does not make the context current");
    }
    void leave() const { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

private:
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;

    void open(EGLDisplay display) {
        constexpr std::array<EGLint, 7> kWanted{
            EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) return;
        display_ = display;
        eglBindAPI(EGL_OPENGL_API);
        for (const char* needed : {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"})
            if (!epoxy_has_egl_extension(display, needed)) return;
        context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kWanted.data());
        if (context_ == EGL_NO_CONTEXT ||
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_FALSE)
            return;
        eglDestroyContext(display, context_);
        context_ = EGL_NO_CONTEXT;
    }

    void prepare() {
        const auto text = [](GLenum name) {
            const GLubyte* found = glGetString(name);
            return found == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(found));
        };
        const std::string version = text(GL_VERSION), renderer = text(GL_RENDERER);
        std::string driver = version.substr(std::min(version.find(' '), version.size() - 1) + 1);
        if (driver.starts_with("(Core Profile) ")) driver.erase(0, std::strlen("(Core Profile) "));
        release = version.substr(0, version.find(' ')) + " (" + renderer.substr(0, renderer.find_first_of("(/")) +
                  ", " + driver + ")";
        if (const auto blank = release.find(" , "); blank != std::string::npos) release.erase(blank, 1);

        linear  = sampler_of(GL_LINEAR);
        nearest = sampler_of(GL_NEAREST);
        glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
        glEnable(GL_DEPTH_TEST);
        glEnable(GL_DEPTH_CLAMP);
        glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    }
};

inline const Context& context() {
    static const Context one;
    return one;
}

struct Current {
    Current() { context().enter(); }
    ~Current() { context().leave(); }
    Current(const Current&)            = delete;
    Current& operator=(const Current&) = delete;
};

/// An object of OpenGL and the function that deletes it; a `Current` is around its life's ends.
template <auto& Delete>
class Named {
public:
    GLuint name                    = 0;
    Named()                        = default;
    Named(const Named&)            = delete;
    Named& operator=(const Named&) = delete;
    ~Named() {
        if (name != 0) Delete(1, &name);
    }
};

struct Buffer : Named<glDeleteBuffers> {
    template <typename T>
    void store(const std::vector<T>& data) {
        glCreateBuffers(1, &name);
        glNamedBufferStorage(name, static_cast<GLsizeiptr>(std::max<std::size_t>(data.size() * sizeof(T), 4)),
                             data.empty() ? nullptr : data.data(), 0);
    }
};

inline void finish() {
    glFinish();
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
        throw std::runtime_error(error == GL_OUT_OF_MEMORY ? "OpenGL is out of memory"
                                                           : "OpenGL fails, error " + std::to_string(error));
}

/// A texture to draw depths into.
struct Target {
    Named<glDeleteTextures> texture;
    Named<glDeleteFramebuffers> frame;

    void make(GLenum kind, GLenum format, GLsizei width, GLsizei height) {
        GLint most = 0;
        glGetIntegerv(kind == GL_TEXTURE_2D ? GL_MAX_TEXTURE_SIZE : GL_MAX_CUBE_MAP_TEXTURE_SIZE, &most);
        if (std::max(width, height) > most)
            throw std::runtime_error("this driver draws at most " + std::to_string(most) + " texels");
        glCreateTextures(kind, 1, &texture.name);
        glTextureStorage2D(texture.name, 1, format, width, height);
        finish();  // is there memory for it?
        glCreateFramebuffers(1, &frame.name);
        glBindFramebuffer(GL_FRAMEBUFFER, frame.name);
        glViewport(0, 0, width, height);
    }
    void attach(GLenum point, int layer) const {
        if (layer < 0)
            glNamedFramebufferTexture(frame.name, point, texture.name, 0);
        else
            glNamedFramebufferTextureLayer(frame.name, point, texture.name, 0, layer);
        if (glCheckNamedFramebufferStatus(frame.name, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            throw std::runtime_error("this driver does not draw into a depth texture of this kind");
    }
};

}  // namespace umbra_opengl
