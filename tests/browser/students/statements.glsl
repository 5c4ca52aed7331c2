// Loops and conditions of all kinds, without braces, with variables in conditions.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    float sum = 0.0;
    int n = 0;
    for (;;) if (++n > 3) break; else sum += 1.0;
    while (n-- > 0) for (int i = 0; i < 2; ++i) { if (i == 1) continue; sum += 0.5; }
    do sum += 0.25; while (++n < 3);
    do { float samples[2]; samples[1] = 0.125; sum += samples[1]; } while (sum < 3.0);
    for (uint i = 0u, film = 2u; i < film; i++)
        for (uint film = 0u; film < 3u; film += 1u)
            sum += float(film) * 0.0625;
    while (bool goes_on = sum < 20.0) sum += goes_on ? 2.0 : 0.0;
    switch (n) {
    case 3: sum += 100.0;
    case 4: { float film = 2.0; sum += film; break; }
    default: for (int film = 0; film < 9; ++film) sum += 1000.0;
    }
    if (sum > 1.0) if (sum > 2000.0) sum = 0.0; else for (int i = 0; i < 2; ++i) sum += 1.0;
    else sum = 3.0;
    return vec3(sum, float(n), 0.5);
}
