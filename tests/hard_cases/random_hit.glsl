// A hit at a uniform point, given by v in [0,1)², on a triangle chosen by u.x.
Hit get_random_hit(vec2 u, vec2 v) {
    Hit hit;
    hit.instance = 0u;
    hit.triangle = min(uint(u.x * float(triangles.length())), uint(triangles.length()) - 1u);
    hit.barycentrics = vec2(sqrt(v.x) * (1.0 - v.y), sqrt(v.x) * v.y);
    return hit;
}
