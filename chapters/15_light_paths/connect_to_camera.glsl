// From a surface to the camera: which pixel sees it, and how much light it sends there.

// What shading normals change where light comes along ω_i and leaves along ω_o. The BSDF's cosine belongs to ω_i where a path
// follows ω_o, and to ω_o where it follows light, |ω_i·n_s| |ω_o·n_g| / (|ω_i·n_g| |ω_o·n_s|) times as much (Veach 1997, 5.3.2).
float get_adjoint_factor(ShadingData s, vec3 omega_i, vec3 omega_o) {
    return abs(dot(omega_i, s.normal) * dot(omega_o, s.geometric_normal) /
               (dot(omega_i, s.geometric_normal) * dot(omega_o, s.normal)));
}

// A random point of the aperture, or the pinhole.
vec3 sample_aperture(inout uvec2 seed) {
    Camera camera = parameters.camera;
#ifdef FEATURE_LENS
    vec2 lens = camera.aperture_radius * sample_disc(get_random_numbers(seed));
    return camera.position + lens.x * normalize(camera.right) + lens.y * normalize(camera.up);
#else
    return camera.position;
#endif
}

// Where the camera sees a point that lies in this direction from a point of its aperture: a position of the image in [-1,1]² that
// points to the right and down, as in sample_camera_ray(). Rays from all of the aperture meet in the plane in focus.
vec2 get_image_position(vec3 on_aperture, vec3 direction) {
    Camera camera = parameters.camera;
    vec3 on_plane = direction / dot(direction, camera.forward);
#ifdef FEATURE_LENS
    on_plane += (on_aperture - camera.position) / camera.focus_distance;
#endif
    return vec2(dot(on_plane, camera.right) / dot(camera.right, camera.right),
                -dot(on_plane, camera.up) / dot(camera.up, camera.up));
}

// Adds the light of x_k to the pixel that sees it. The pixels cover 4 |right| |up| of the plane at distance 1, and a piece of it
// is seen under a solid angle of cos³ θ_c times its area. So an area of cos θ / r² as seen from the lens receives
// ρ · power · cos θ / (r² cos³ θ_c · 4 |right| |up|), whatever the number of pixels.
void connect_to_camera(ShadingData s, vec3 power, uint sample_index, inout uvec2 seed) {
    vec3 on_aperture = sample_aperture(seed);
    vec3 to_camera = on_aperture - s.position;
    float distance = length(to_camera);
    vec3 omega = to_camera / distance, omega_i = s.out_direction;
    float cos_camera = -dot(omega, parameters.camera.forward);
    if (!(cos_camera > 0.0) || !is_above_surface(s, omega)) return;
    vec2 position = get_image_position(on_aperture, -omega);
    if (!all(lessThan(abs(position), vec2(1.0)))) return;
    if (is_occluded(get_ray_to_point(s, on_aperture), 1.0)) return;

    // ρ as the camera sees it: ω_o leads there. That of rough glass has the sign of its cosine, so it is negative behind the surface.
    float cos_o = abs(dot(s.normal, omega)) * get_adjoint_factor(s, omega_i, omega);
    s.out_direction = omega;
#ifdef FEATURE_MICROFACETS
    if (dot(s.geometric_normal, omega) < 0.0) {  // through rough glass
        s.geometric_normal = -s.geometric_normal;
        s.normal = -s.normal;
        s.relative_index = 1.0 / s.relative_index;
    }
#endif
    float picture_area = 4.0 * length(parameters.camera.right) * length(parameters.camera.up);
    vec3 radiance = power * abs(get_brdf(s, omega_i)) *
                    (cos_o / (distance * distance * cos_camera * cos_camera * cos_camera * picture_area));
    uvec2 pixel = uvec2((0.5 + 0.5 * position) * vec2(parameters.image_size));
    add_splat(min(pixel, parameters.image_size - 1u), radiance, sample_index);
}
