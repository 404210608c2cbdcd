// How the organ is lit. A light goes along with the camera, up and to the side: a tool throws its shadow away from where
// it would touch, and the two meet at contact, which tells a mouse user the depth. A rod's shadow on a point is found from
// the distance between the rod and the ray to the light (Quilez, "capsule - soft shadow"); no shadow maps.

export const kVertex = `
attribute float value;
attribute float flags;
varying vec3 v_place;
varying vec3 v_normal;
varying float v_value;
varying float v_fixed;
varying float v_reach;
void main() {
  v_place = position;
  v_normal = normal;
  v_value = value;
  v_fixed = mod(flags, 2.0);
  v_reach = mod(floor(flags / 2.0), 2.0);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const kFragment = `
uniform vec3 ramp[6];
uniform float top;
uniform vec3 light;
uniform vec3 fill;
uniform float regions;
uniform float alpha;
uniform int casters;
uniform vec4 tips[8];
uniform vec4 ends[8];
varying vec3 v_place;
varying vec3 v_normal;
varying float v_value;
varying float v_fixed;
varying float v_reach;

vec3 coloured(float share) {
  float x = clamp(share, 0.0, 1.0) * 5.0;
  vec3 colour = ramp[0];
  for (int i = 0; i < 5; i++) colour = mix(colour, ramp[i + 1], clamp(x - float(i), 0.0, 1.0));
  return colour;
}

// How much light a ball, or a rod from a to b, leaves: 1 all of it.
float past_ball(vec3 from, vec3 centre, float radius) {
  vec3 to = centre - from;
  float along = max(dot(to, light), 1e-4);
  float miss = length(to - along * light) - radius;
  return smoothstep(-0.5, 0.5, miss / (0.25 * along + 0.35 * radius));
}

float past_rod(vec3 from, vec3 a, vec3 b, float radius) {
  vec3 ba = b - a;
  vec3 oa = from - a;
  float oad = dot(oa, light), dba = dot(light, ba), baba = dot(ba, ba), oaba = dot(oa, ba);
  float lost = max(baba - dba * dba, 1e-9);
  float along = max((-oad * baba + dba * oaba) / lost, 1e-4);
  float share = clamp((oaba - oad * dba) / lost, 0.0, 1.0);
  float miss = length(from + light * along - (a + ba * share)) - radius;
  return smoothstep(-0.5, 0.5, miss / (0.22 * along + 0.6 * radius));
}

void main() {
  vec3 n = normalize(v_normal);
  vec3 view = normalize(cameraPosition - v_place);
  if (dot(n, view) < 0.0) n = -n;
  vec3 colour = coloured(v_value / top);
  if (regions > 0.5) {
    float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 11.0));
    vec3 grey = vec3(dot(colour, vec3(0.3, 0.59, 0.11)));
    colour = mix(mix(grey * 0.72, colour * 0.8, 0.2), colour * 1.12, smoothstep(0.4, 0.6, v_reach));
    colour = mix(colour, mix(vec3(0.2, 0.36, 0.5), vec3(0.42, 0.64, 0.78), stripe), smoothstep(0.4, 0.6, v_fixed));
  }
  float facing = dot(n, light);
  float lit = max(0.0, 0.82 * facing + 0.18);
  float shade = 1.0;
  for (int i = 0; i < 8; i++) {
    if (i >= casters) break;
    shade = min(shade, past_ball(v_place, tips[i].xyz, tips[i].w));
    if (ends[i].w > 0.0) shade = min(shade, past_rod(v_place, tips[i].xyz, ends[i].xyz, ends[i].w));
  }
  shade = mix(1.0, shade, smoothstep(-0.05, 0.25, facing));
  float side = max(0.0, 0.6 * dot(n, fill) + 0.4);
  vec3 halfway = normalize(light + view);
  float gloss = pow(max(0.0, dot(n, halfway)), 42.0) * 0.14 * shade;
  float rim = pow(1.0 - max(0.0, dot(n, view)), 3.0);
  vec3 out_colour = colour * (0.25 + 0.68 * lit * mix(0.12, 1.0, shade) + 0.18 * side * mix(0.4, 1.0, shade));
  out_colour += gloss + rim * 0.1;
  gl_FragColor = vec4(out_colour, mix(alpha, min(1.0, alpha + 0.5 * rim), step(alpha, 0.99)));
}`;
