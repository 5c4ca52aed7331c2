// Interpolates the vertices of the hit triangle. The normal points to the front.
SurfacePoint get_surface_point(Hit hit) {
    SurfacePoint point;
    vec3 w = get_vertex_weights(hit);
    uvec3 corners = triangles[hit.triangle];
    vec3 x_0 = positions[corners.x], x_1 = positions[corners.y], x_2 = positions[corners.z];
    point.position = interpolate(x_0, x_1, x_2, w);
    vec3 magnitude = interpolate(abs(x_0), abs(x_1), abs(x_2), w);
    // Counter-clockwise seen from the front: the loader makes sure of that.
    vec3 edge_1 = x_1 - x_0, edge_2 = x_2 - x_0;
    vec3 normal = get_scaled_normal(edge_1, edge_2);
    point.offset = get_error_bound(magnitude, normal);
    // A triangle so narrow that its area underflows: any direction perpendicular to its longer edge will do.
    if (normal == vec3(0.0))
        normal = get_shading_space(
            normalize_scaled(max_component(edge_1) > max_component(edge_2) ? edge_1 : edge_2))[0];
    point.geometric_normal = normalize_scaled(normal);
#ifdef FEATURE_TRANSFORMS
    Instance instance = instances[hit.instance];
    mat3 linear = mat3(instance.object_to_world);
    point.position = linear * point.position + instance.object_to_world[3];
    magnitude = mat3(abs(linear[0]), abs(linear[1]), abs(linear[2])) * magnitude + abs(instance.object_to_world[3]);
    // Some backends intersect in object space and others in world space, so the bound covers both. The transformation into world
    // space stretches a distance from the triangle by as much as it shortens the normal.
    normal = instance.normal_to_world * point.geometric_normal;
    point.geometric_normal = normalize_scaled(normal);
    point.offset = max(point.offset / dot(normal, point.geometric_normal),
                       get_error_bound(magnitude, get_scaled_normal(linear * edge_1, linear * edge_2)));
#endif
    return point;
}
