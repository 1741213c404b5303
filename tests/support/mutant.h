// Changes to files of any kind.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace umbra {

/// One small change to a file: bytes turned, cut out, doubled or swapped, or a number put where another stood.
inline std::string mutant(const std::string& original, std::mt19937& random) {
    static const std::vector<std::string> kNumbers{"0",
                                                   "-1",
                                                   "1",
                                                   "4294967295",
                                                   "4294967296",
                                                   "-2147483649",
                                                   "9223372036854775807",
                                                   "18446744073709551616",
                                                   "1e39",
                                                   "1e400",
                                                   "-0",
                                                   "nan",
                                                   "inf",
                                                   "-inf",
                                                   "0x10",
                                                   "1e-400",
                                                   "1.5",
                                                   "",
                                                   "\"",
                                                   "{",
                                                   "]",
                                                   "255",
                                                   "65536",
                                                   "99999999"};
    std::string s    = original;
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : std::size_t(random() % n); };
    for (std::size_t changes = 1 + below(3); changes > 0 && !s.empty(); --changes) {
        const std::size_t at = below(s.size());
        switch (below(7)) {
            case 0: s[at] = static_cast<char>(random() & 0xff); break;
            case 1: s[at] = static_cast<char>(s[at] ^ (1 << below(8))); break;
            case 2: s.erase(at, 1 + below(8)); break;
            case 3: s.insert(at, s.substr(below(s.size()), below(40))); break;
            case 4: s.resize(at); break;
            case 5: {  // the number at or after `at`
                const std::size_t begin = s.find_first_of("0123456789", at);
                if (begin == s.npos) break;
                const std::size_t end = std::min(s.find_first_not_of("0123456789.eE+-", begin), s.size());
                s.replace(begin, end - begin, kNumbers[below(kNumbers.size())]);
                break;
            }
            default:  // four bytes of a binary field
                for (std::size_t k = at; k < std::min(at + 4, s.size()); ++k)
                    s[k] = below(2) == 0 ? '\xff' : static_cast<char>(0x7f);
        }
    }
    return s;
}

}  // namespace umbra
