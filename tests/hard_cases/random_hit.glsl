// A uniform point of a triangle that u.x chooses, v in [0,1)² the point: as if a ray had hit it.
Hit get_random_hit(vec2 u, vec2 v) {
    Hit hit;
    hit.instance = 0u;
    hit.triangle = min(uint(u.x * float(triangles.length())), uint(triangles.length()) - 1u);
    hit.barycentrics = vec2(sqrt(v.x) * (1.0 - v.y), sqrt(v.x) * v.y);
    return hit;
}
