vec2 cos_sin_turns(float u) { return vec2(cos(6.283185307179586 * u), sin(6.283185307179586 * u)); }
float cube_root(float x) { return pow(x, 1.0 / 3.0); }
float power(float x, float y) { return y == 0.0 ? 1.0 : pow(x, y); }
