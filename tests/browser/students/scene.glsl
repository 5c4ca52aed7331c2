// The scene's arrays in a student's text, as elements, members, lengths and copies.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return vec3(0.0);
    uvec3 corners = triangles[hit.triangle];
    Material material = materials[triangle_materials[hit.triangle]];
    vec3 middle = (positions[corners.x] + positions[corners[1]] + positions[triangles[hit.triangle].z]) / 3.0;
    float count = float(materials.length() + triangles.length()) + float(light_triangles.length());
    LightTriangle light = light_triangles[light_triangles.length() - 1];
    return material.diffuse_albedo + materials[triangle_materials[hit.triangle]].emission[0] + 0.001 * middle + count + float(light.triangle);
}
