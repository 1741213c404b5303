// A method that is a program of its own, for tests: outside_program SCENE POINTS LIGHT OUT. SCENE holds triangles, nine
// doubles each; POINTS a position, three doubles, and the point's triangle each; LIGHT is "x,y,z"; OUT gets one float a
// point, 1 where no triangle lies between the point and the light.
#include <cstdio>
#include <fstream>
#include <vector>

namespace {

struct Vec {
    double x, y, z;
};
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
struct Triangle {
    Vec a, b, c;
};
struct Point {
    Vec p;
    double triangle;
};

template <class T>
std::vector<T> read(const char* file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    std::vector<T> list(static_cast<std::size_t>(in.tellg()) / sizeof(T));
    in.seekg(0).read(reinterpret_cast<char*>(list.data()), static_cast<std::streamsize>(list.size() * sizeof(T)));
    return list;
}

}  // namespace

int main(int argc, char** argv) {
    Vec light{};
    if (argc != 5 || std::sscanf(argv[3], "%lf,%lf,%lf", &light.x, &light.y, &light.z) != 3) return 64;
    const auto triangles = read<Triangle>(argv[1]);
    std::ofstream out(argv[4], std::ios::binary);
    for (const Point& at : read<Point>(argv[2])) {
        float s = 1;
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const auto& [a, b, c] = triangles[t];
            const Vec d = light - at.p, n = cross(b - a, c - a), q = cross(d, at.p - a);
            const double slope = -dot(n, d), h = dot(n, at.p - a) / slope, u = -dot(c - a, q) / slope,
                         v = dot(b - a, q) / slope;
            if (static_cast<double>(t) != at.triangle && slope != 0 && h > 0 && h < 1 && u >= 0 && v >= 0 && u + v <= 1)
                s = 0;
        }
        out.write(reinterpret_cast<const char*>(&s), sizeof s);
    }
    return out ? 0 : 4;
}
