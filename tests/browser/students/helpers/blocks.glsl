vec3 get_blocks(vec3 film) {
    film[0] = 1.0;
    return film * vec3(1.0, 0.0, 0.0);
}
