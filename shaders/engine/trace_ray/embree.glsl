// trace_ray() by Embree, for the `native` backend only: it replaces the functions native_…() by those in common/native/glsl.h.
bool native_closest_hit(vec3 origin, vec3 direction, float t_max, out uint instance, out uint triangle, out vec2 barycentrics,
                        out float t) {
    return false;
}
bool native_any_hit(vec3 origin, vec3 direction, float t_max) { return false; }

// Finds the closest hit nearer than t_max, and returns whether there is one.
bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    if (!native_closest_hit(ray.origin, ray.direction, t_max, hit.instance, hit.triangle, hit.barycentrics, hit.distance))
        return false;
#ifdef FEATURE_DIELECTRICS
    hit.material_class = get_material_class(hit.triangle);
#endif
    return true;
}

// Whether anything is hit nearer than t_max. Any hit will do.
bool is_occluded(Ray ray, float t_max) {
    ++ray_count;
    return native_any_hit(ray.origin, ray.direction, t_max);
}
