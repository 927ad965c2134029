//! The shading programs, for WebGL2 and for OpenGL 3.2 and later.

/// Triangles: a colour each, shaded by the side they turn to the camera, with lines along their sides.
pub(super) const FACES: [&str; 2] = [
    r"
in vec3 a_position;
uniform mat4 u_matrix;
uniform highp usampler2D u_faces;
uniform int u_row;
uniform int u_hover;
flat out vec4 v_colour;
flat out uint v_sides;
flat out float v_glow;
out vec3 v_corner;
out vec3 v_position;
void main() {
    int face = gl_VertexID / 3;
    int corner = gl_VertexID - 3 * face;
    uvec4 data = texelFetch(u_faces, ivec2(face % u_row, face / u_row), 0);
    v_colour = vec4(vec3(data.rgb) / 255.0, 1.0);
    v_sides = data.a;
    v_glow = face == u_hover ? 1.0 : 0.0;
    v_corner = vec3(corner == 0, corner == 1, corner == 2);
    v_position = a_position;
    gl_Position = u_matrix * vec4(a_position, 1.0);
}
",
    r"
flat in vec4 v_colour;
flat in uint v_sides;
flat in float v_glow;
in vec3 v_corner;
in vec3 v_position;
uniform vec3 u_light;
uniform float u_shading;
uniform float u_wire;
uniform float u_borders;
uniform vec3 u_ink;
uniform vec4 u_cover;
uniform float u_scale;
out vec4 o_colour;
float line(float distance, float width) {
    return 1.0 - smoothstep(width - 0.6, width + 0.6, distance);
}
void main() {
    if (u_cover.a > 0.0) {
        o_colour = vec4(u_cover.rgb * u_cover.a, u_cover.a);
        return;
    }
    vec3 normal = normalize(cross(dFdx(v_position), dFdy(v_position)));
    float facing = abs(dot(normal, u_light));
    vec3 colour = v_colour.rgb * mix(1.0, 0.34 + 0.66 * facing, u_shading);
    vec3 slope = max(fwidth(v_corner), vec3(1e-6));
    vec3 distance = (v_corner / slope).zxy / u_scale;
    float height = 1.0 / (max(slope.x, max(slope.y, slope.z)) * u_scale);
    float wire = u_wire * smoothstep(3.0, 14.0, height) * line(min(distance.x, min(distance.y, distance.z)), 0.5);
    colour = mix(colour, u_ink, 0.45 * wire);
    for (int side = 0; side < 3; side++) {
        uint kind = (v_sides >> uint(2 * side)) & 3u;
        float border = kind == 2u ? 0.8 * line(distance[side], 0.8) : kind == 1u ? 0.3 * line(distance[side], 0.5) : 0.0;
        // Where triangles are smaller than lines, lines would hide everything.
        border *= mix(0.3, 1.0, smoothstep(1.5, 7.0, height));
        colour = mix(colour, u_ink, u_borders * border);
    }
    if (((v_sides >> 6) & 1u) == 1u) {
        colour = mix(colour, vec3(1.0, 0.83, 0.1), 0.5);
    }
    colour = mix(colour, vec3(1.0, 1.0, 1.0), 0.75 * v_glow);
    o_colour = vec4(colour, 1.0);
}
",
];

/// Points: discs of a size on the screen, lifted a little towards the eye so that their own surface does not hide them.
pub(super) const POINTS: [&str; 2] = [
    r"
in vec3 a_position;
in vec4 a_colour;
uniform mat4 u_matrix;
uniform vec3 u_eye;
uniform float u_lift;
uniform float u_size;
flat out vec4 v_colour;
void main() {
    vec3 towards = u_eye - a_position;
    vec3 place = a_position + u_lift * towards / max(length(towards), 1e-20);
    v_colour = a_colour;
    gl_Position = u_matrix * vec4(place, 1.0);
    gl_PointSize = u_size;
}
",
    r"
flat in vec4 v_colour;
uniform float u_size;
uniform vec3 u_rim;
out vec4 o_colour;
void main() {
    float radius = 0.5 * u_size * length(2.0 * gl_PointCoord - 1.0);
    float outer = 0.5 * u_size;
    float alpha = 1.0 - smoothstep(outer - 1.0, outer, radius);
    if (alpha <= 0.0) {
        discard;
    }
    float rim = smoothstep(0.68 * outer - 0.6, 0.68 * outer + 0.6, radius);
    o_colour = vec4(mix(v_colour.rgb, u_rim, rim) * alpha, alpha);
}
",
];
