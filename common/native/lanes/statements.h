// What lanes execute: assignments, branches and loops under masks, and their way to memory.
//
// All lanes share one instruction stream, so they cannot part at a branch. They walk through both sides instead, and a mask says
// whose variables may change. For
//
//     if (x < 0.0) y = -x; else y = 1.0;
//
// the lanes execute, where `active` is the mask of those that have come here,
//
//     Branch branch(active, x < 0.0f);                      // narrows `active` to lanes with x < 0
//     if (branch.begins()) assign(active, y, -x);           // skipped if there is none
//     if (branch.turns()) assign(active, y, 1.0f);          // the other ones
//     branch.ends();                                        // all that have come here
#pragma once
#include "native/lanes/lanes.h"

namespace lab::native::lanes {

// Where a mask holds, `a`, elsewhere `b`.
template <typename T>
LAB_INLINE Lanes<T> select(const Mask& mask, const Lanes<T>& a, const Lanes<T>& b) {
    return Lanes<T>::of(mask.raw ? a.raw : b.raw);
}
template <typename A, typename B>
LAB_INLINE auto select(const Mask& mask, const A& a, const B& b);

// Memory at an address for each lane, of which `offset` counts words of four bytes: up to 2^32, as in an unsigned number.
template <typename T>
struct Ref {
    T* base;
    Lanes<int> offset;
    uint32_t word(int lane) const { return static_cast<uint32_t>(offset[lane]); }
};
template <typename T>
inline constexpr bool is_ref = false;
template <typename T>
inline constexpr bool is_ref<Ref<T>> = true;

// Changes a variable in the lanes of a mask.
template <typename T, typename U>
LAB_INLINE void assign(const Mask& mask, T& target, const U& value) {
    if constexpr (is_number<T>)
        target = select(mask, T(value), target);
    else if constexpr (requires { typename T::VaryingStruct__; })
        T::fields__([&](auto& x, const auto& y) { assign(mask, x, y); }, target, T(value));
    else
        for (int i = 0; i < T::length(); ++i) assign(mask, target[i], value[i]);
}
template <typename A, typename B>
LAB_INLINE auto select(const Mask& mask, const A& a, const B& b) {
    if constexpr (is_number<A>) {
        return each([&]<typename X, typename Y>(
                        const X& x, const Y& y) { return select(mask, Lanes<Element<X, Y>>(x), Lanes<Element<X, Y>>(y)); },
                    a, b);
    } else {
        auto result = varying(b);
        assign(mask, result, a);
        return result;
    }
}

// Statements change the mask of those that `active` execute. Each gives back at its end what it took from it.
struct Branch {
    Mask& active;
    Mask rest;
    LAB_INLINE Branch(Mask& active, const Mask& condition) : active(active), rest(active & !condition) {
        active = active & condition;
    }
    LAB_INLINE bool begins() const { return any(active); }
    LAB_INLINE bool turns() {  // to `else`
        std::swap(active, rest);
        return any(active);
    }
    LAB_INLINE void ends() { active = active | rest; }
};
// A loop turns until no lane is left in it. One that leaves (`break`) is out of `active` until the loop ends; one that skips the
// rest of a turn (`continue`) waits for the next. So a path of three bounces beside one of thirty waits for it: lanes pay off
// where neighbours do the same.
struct Loop {
    Mask& active;
    Mask ended = false, waiting = false;
    LAB_INLINE explicit Loop(Mask& active) : active(active) {}
    LAB_INLINE bool goes_on(const Mask& condition) {
        ended = ended | (active & !condition);
        active = active & condition;
        return any(active);
    }
    LAB_INLINE void leave() {
        ended = ended | active;
        active = false;
    }
    LAB_INLINE void skip() {
        waiting = waiting | active;
        active = false;
    }
    LAB_INLINE void next() {
        active = active | waiting;
        waiting = false;
    }
    LAB_INLINE void ends() { active = active | ended; }
};

// A `switch`: lanes enter it at their case, and go on until they leave it.
struct Cases {
    Mask& active;
    Mask waiting, ended = false;
    LAB_INLINE explicit Cases(Mask& active) : active(active), waiting(active) { active = false; }
    LAB_INLINE void enter(const Mask& condition) {
        const Mask chosen = waiting & condition;
        active = active | chosen;
        waiting = waiting & !chosen;
    }
    LAB_INLINE void leave() {
        ended = ended | active;
        active = false;
    }
    LAB_INLINE void ends() { active = active | ended | waiting; }
};
LAB_INLINE Mask is_one_of(const Lanes<uint>& selector, std::initializer_list<uint> literals) {
    Mask result = false;
    for (const uint literal : literals) result = result | (selector == literal);
    return result;
}

// Memory: where the index is the same for all lanes, they read one place, and else each reads its own (a `gather`). Those that
// are not active read nothing, since their index may be any number. Code runs only if some lane is active, so arrays have a first
// element.
template <typename T>
inline constexpr int word_count = static_cast<int>(sizeof(T) / 4);
template <typename T>
LAB_INLINE Ref<T> ref_to(T& first, const Lanes<int>& offset) {
    return {&first, offset};
}
template <typename C, typename I>
requires requires(C& container) { container[0]; }
LAB_INLINE auto at(C&& container, const I& index) {
    return ref_to(container[0], Lanes<int>(index) * word_count<std::remove_reference_t<decltype(container[0])>>);
}
template <typename T, typename I>
LAB_INLINE auto at(const Ref<T>& ref, const I& index) {
    auto inner = at(*ref.base, index);
    inner.offset = inner.offset + ref.offset;
    return inner;
}
template <typename T, typename F>
LAB_INLINE auto field(const Ref<T>& ref, const F& f) {
    return ref_to(f(*ref.base), ref.offset);
}

// Loads `count` words in a row for each lane. Rows that are transposed are several times as fast as gathering words.
template <int count>
LAB_INLINE void load_words(const Mask& mask, const void* base, const Lanes<int>& offset, Lanes<int>* words) {
    if constexpr (count < 4) {
        // It takes signed numbers: those from the middle of the words.
        const int* const middle = static_cast<const int*>(base) + (size_t{1} << 31);
        for (int word = 0; word < count; ++word) words[word].raw = gather(mask.raw, middle + word, offset.raw ^ INT32_MIN);
        return;
    }
    uint32_t offsets[lane_count];
    const auto first = offset.raw & mask.raw;  // idle lanes read the first element
    std::memcpy(offsets, &first, sizeof offsets);
    for (int word = 0; word < count; word += 4) {
        const int begin = std::min(word, count - 4);
        const auto rows = [&](int lane) {
            return every_fourth([&](int more) {
                Four row;
                std::memcpy(&row, static_cast<const int*>(base) + offsets[lane + more] + begin, sizeof row);
                return row;
            });
        };
        const Integers a = rows(0), b = rows(1), c = rows(2), d = rows(3);
        const Integers low_ab = shuffle_fours<0, 4, 1, 5>(a, b), low_cd = shuffle_fours<0, 4, 1, 5>(c, d),
                       high_ab = shuffle_fours<2, 6, 3, 7>(a, b), high_cd = shuffle_fours<2, 6, 3, 7>(c, d);
        words[begin].raw = shuffle_fours<0, 1, 4, 5>(low_ab, low_cd);
        words[begin + 1].raw = shuffle_fours<2, 3, 6, 7>(low_ab, low_cd);
        words[begin + 2].raw = shuffle_fours<0, 1, 4, 5>(high_ab, high_cd);
        words[begin + 3].raw = shuffle_fours<2, 3, 6, 7>(high_ab, high_cd);
    }
}
// Calls `f` for each number, in the order of memory.
template <typename T, typename F>
LAB_INLINE void for_each_part(T& target, const F& f) {
    static_assert(!std::is_same_v<T, Mask>, "bools have one byte in memory");
    if constexpr (is_number<T> && size_of<T> == 1)
        f(target);
    else if constexpr (requires { typename T::VaryingStruct__; })
        T::fields__([&](auto& x) { for_each_part(x, f); }, target);
    else
        for (int i = 0; i < T::length(); ++i) for_each_part(target[i], f);
}
template <typename T>
LAB_INLINE auto load(const Mask& mask, const Ref<T>& ref) {
    Lanes<int> words[word_count<T>];
    load_words<word_count<T>>(mask, ref.base, ref.offset, words);
    V<std::remove_const_t<T>> result;
    const Lanes<int>* next = words;
    for_each_part(result, [&](auto& x) { std::memcpy(&x.raw, next++, sizeof x.raw); });
    return result;
}
template <typename T, typename U>
LAB_INLINE void store(const Mask& mask, const Ref<T>& ref, const U& value) {
    V<T> all(value);
    Lanes<int> words[word_count<T>], *next = words;
    for_each_part(all, [&](const auto& x) { std::memcpy(next++, &x.raw, sizeof x.raw); });
    for_each_lane(mask, [&](int lane) {
        int32_t* word = reinterpret_cast<int32_t*>(ref.base) + ref.word(lane);
        for (const Lanes<int>& x : words) *word++ = x[lane];
    });
}
// An element of an array or a vector of lanes, in each lane a different one.
template <typename C>
LAB_INLINE auto pick(const C& container, const Lanes<int>& index) {
    auto result = container[0];
    for (int i = 1; i < C::length(); ++i) assign(equal(index, i), result, container[i]);
    return result;
}

template <typename C, typename F>
LAB_INLINE void put(const Mask& mask, C& container, const Lanes<int>& index, const F& change) {
    for (int i = 0; i < C::length(); ++i) change(container[i], mask & equal(index, i));
}

// Constructors: of a vector by the components of all arguments, or by one for all.
template <typename T, typename... A>
LAB_INLINE auto make(const A&... x) {
    if constexpr (!(is_varying<A> || ...)) {
        return native::make<T>(x...);
    } else {
        V<T> result;
        int next = 0;
        const auto append = [&]<typename U>(const U& y) {
            for (int i = 0; i < size_of<U>; ++i, ++next) {
                if constexpr (is_matrix<T>)
                    result[next / T::col_type::length()][next % T::col_type::length()] = component(y, i);
                else
                    result[next] = component(y, i);
            }
        };
        (append(x), ...);
        return result;
    }
}
template <typename T, typename U>
LAB_INLINE auto convert(const U& x) {
    if constexpr (Varying<U>)
        return V<T>(x);
    else
        return T(x);
}
template <typename T, typename U>
LAB_INLINE auto bits(const U& x) {
    if constexpr (Varying<U>) {
        using Number = std::remove_cvref_t<decltype(component(std::declval<T>(), 0))>;
        return each([](const auto& y) { return Lanes<Number>::of(reinterpret_cast<typename Lanes<Number>::Raw>(y.raw)); }, x);
    } else {
        return native::bits<T>(x);
    }
}
template <int... i, typename A, typename B>
LAB_INLINE auto shuffle(const A& a, const B& b) {
    if constexpr (Varying<A, B>) {
        Vec<sizeof...(i), Lanes<Element<decltype(component(a, 0)), decltype(component(b, 0))>>> result;
        int next = 0;
        ((result[next++] = i < size_of<A> ? Lanes<Element<decltype(component(a, 0))>>(component(a, i < size_of<A> ? i : 0))
                                          : component(b, i < size_of<A> ? 0 : i - size_of<A>)),
         ...);
        return result;
    } else {
        return native::shuffle<i...>(a, b);
    }
}

}  // namespace lab::native::lanes
