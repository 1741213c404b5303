// Records in files that people write: a mistyped member is refused.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/record/record.h"

namespace umbra {
namespace record_parts {

/// Refuses the first member of an object that is none of `known`.
void require_members_among(const Field& field, const std::vector<std::string>& known);

template <class T>
void refuse_unknown(const Field& field);

/// Gathers the names of the members of a record, and looks into those that are there.
template <class T>
class Knower : public Fields<Knower<T>> {
public:
    explicit Knower(const Field& field) : field_(field) {}
    template <class V, class C>
    void take(Kind, std::string_view key, V C::*, std::string_view, const Allowed&) {
        known.emplace_back(key);
        refuse_unknown<V>(field_[key]);
    }
    template <class V, class C>
    void part(V C::*) {
        Knower<V> part(field_);
        describe(part, Is<V>{});
        known.insert(known.end(), part.known.begin(), part.known.end());
    }
    std::vector<std::string> known;

private:
    const Field& field_;
};

template <class T>
void refuse_unknown(const Field& field) {
    if constexpr (Part<T>::optional) {
        refuse_unknown<typename Part<T>::Of>(field);
    } else if constexpr (Part<T>::array) {
        if (field.is_array())
            for (const Field& item : field.items()) refuse_unknown<typename Part<T>::Of>(item);
    } else if constexpr (Part<T>::members) {
        if (field.is_object())
            for (const auto& [key, item] : field.members()) refuse_unknown<typename Part<T>::Of>(item);
    } else if constexpr (Record<T>) {
        if (!field.is_object()) return;  // refused when it is read
        Knower<T> knower(field);
        describe(knower, Is<T>{});
        require_members_among(field, knower.known);
    }
}

}  // namespace record_parts

/// As from_record; a member that the description lacks is refused.
template <class T>
[[nodiscard]] T from_strict_record(const Field& field) {
    record_parts::refuse_unknown<T>(field);
    return from_record<T>(field);
}

}  // namespace umbra
