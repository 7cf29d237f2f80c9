// SPDX-License-Identifier: MIT
// Random numbers (SEMANTICS 7): each is k / 2^24, a function of pixel, frame, ray, dimension and seed. Four come at a
// time, in blocks: of the pixel's place, the lens, the normal of a reflection, then of each light.

// Seed, low and high word; texels of a layer of noise (a power of two); the frame of the first layer
// (tracer/random_numbers.h).
uniform ivec4 u_random;

#ifdef RANDOM_HASH
// Mixes four words: a bijection in which every bit of the input reaches every bit of the output. PCG4D (Jarzynski and
// Olano 2020) with a third round; with two, the upper bits of a word reach the others by halves.
uvec4 mix_words(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
  return v;
}

// (seed, ray, block) give a key of 128 bits, each another one; of each key, no two (pixel, frame) give the same words.
uvec4 random_words(uint pixel, uint frame, uint ray, uint block) {
  uvec4 key = mix_words(uvec4(u_random.xy, ray, block));
  return mix_words(key + uvec4(pixel, frame, 0u, 0u));
}
#endif

#ifdef RANDOM_MD5
// One block of MD5 (RFC 1321) of a message of up to 55 bytes, padded, in 16 words of which the first byte is the lowest.
#define MIX_1(x, y, z) (((x) & (y)) | (~(x) & (z)))
#define MIX_2(x, y, z) (((x) & (z)) | ((y) & ~(z)))
#define MIX_3(x, y, z) ((x) ^ (y) ^ (z))
#define MIX_4(x, y, z) ((y) ^ ((x) | ~(z)))
uint md5_step(uint b, uint sum, int left) { return b + ((sum << left) | (sum >> (32 - left))); }
#define STEP(MIX, a, b, c, d, word, left, constant) a = md5_step(b, a + MIX(b, c, d) + word + constant, left);
uvec4 md5_block(uvec4 m0, uvec4 m1, uvec4 m2, uvec4 m3) {
  uint a = 0x67452301u, b = 0xefcdab89u, c = 0x98badcfeu, d = 0x10325476u;
  STEP(MIX_1, a, b, c, d, m0.x, 7, 0xd76aa478u) STEP(MIX_1, d, a, b, c, m0.y, 12, 0xe8c7b756u)
  STEP(MIX_1, c, d, a, b, m0.z, 17, 0x242070dbu) STEP(MIX_1, b, c, d, a, m0.w, 22, 0xc1bdceeeu)
  STEP(MIX_1, a, b, c, d, m1.x, 7, 0xf57c0fafu) STEP(MIX_1, d, a, b, c, m1.y, 12, 0x4787c62au)
  STEP(MIX_1, c, d, a, b, m1.z, 17, 0xa8304613u) STEP(MIX_1, b, c, d, a, m1.w, 22, 0xfd469501u)
  STEP(MIX_1, a, b, c, d, m2.x, 7, 0x698098d8u) STEP(MIX_1, d, a, b, c, m2.y, 12, 0x8b44f7afu)
  STEP(MIX_1, c, d, a, b, m2.z, 17, 0xffff5bb1u) STEP(MIX_1, b, c, d, a, m2.w, 22, 0x895cd7beu)
  STEP(MIX_1, a, b, c, d, m3.x, 7, 0x6b901122u) STEP(MIX_1, d, a, b, c, m3.y, 12, 0xfd987193u)
  STEP(MIX_1, c, d, a, b, m3.z, 17, 0xa679438eu) STEP(MIX_1, b, c, d, a, m3.w, 22, 0x49b40821u)
  STEP(MIX_2, a, b, c, d, m0.y, 5, 0xf61e2562u) STEP(MIX_2, d, a, b, c, m1.z, 9, 0xc040b340u)
  STEP(MIX_2, c, d, a, b, m2.w, 14, 0x265e5a51u) STEP(MIX_2, b, c, d, a, m0.x, 20, 0xe9b6c7aau)
  STEP(MIX_2, a, b, c, d, m1.y, 5, 0xd62f105du) STEP(MIX_2, d, a, b, c, m2.z, 9, 0x02441453u)
  STEP(MIX_2, c, d, a, b, m3.w, 14, 0xd8a1e681u) STEP(MIX_2, b, c, d, a, m1.x, 20, 0xe7d3fbc8u)
  STEP(MIX_2, a, b, c, d, m2.y, 5, 0x21e1cde6u) STEP(MIX_2, d, a, b, c, m3.z, 9, 0xc33707d6u)
  STEP(MIX_2, c, d, a, b, m0.w, 14, 0xf4d50d87u) STEP(MIX_2, b, c, d, a, m2.x, 20, 0x455a14edu)
  STEP(MIX_2, a, b, c, d, m3.y, 5, 0xa9e3e905u) STEP(MIX_2, d, a, b, c, m0.z, 9, 0xfcefa3f8u)
  STEP(MIX_2, c, d, a, b, m1.w, 14, 0x676f02d9u) STEP(MIX_2, b, c, d, a, m3.x, 20, 0x8d2a4c8au)
  STEP(MIX_3, a, b, c, d, m1.y, 4, 0xfffa3942u) STEP(MIX_3, d, a, b, c, m2.x, 11, 0x8771f681u)
  STEP(MIX_3, c, d, a, b, m2.w, 16, 0x6d9d6122u) STEP(MIX_3, b, c, d, a, m3.z, 23, 0xfde5380cu)
  STEP(MIX_3, a, b, c, d, m0.y, 4, 0xa4beea44u) STEP(MIX_3, d, a, b, c, m1.x, 11, 0x4bdecfa9u)
  STEP(MIX_3, c, d, a, b, m1.w, 16, 0xf6bb4b60u) STEP(MIX_3, b, c, d, a, m2.z, 23, 0xbebfbc70u)
  STEP(MIX_3, a, b, c, d, m3.y, 4, 0x289b7ec6u) STEP(MIX_3, d, a, b, c, m0.x, 11, 0xeaa127fau)
  STEP(MIX_3, c, d, a, b, m0.w, 16, 0xd4ef3085u) STEP(MIX_3, b, c, d, a, m1.z, 23, 0x04881d05u)
  STEP(MIX_3, a, b, c, d, m2.y, 4, 0xd9d4d039u) STEP(MIX_3, d, a, b, c, m3.x, 11, 0xe6db99e5u)
  STEP(MIX_3, c, d, a, b, m3.w, 16, 0x1fa27cf8u) STEP(MIX_3, b, c, d, a, m0.z, 23, 0xc4ac5665u)
  STEP(MIX_4, a, b, c, d, m0.x, 6, 0xf4292244u) STEP(MIX_4, d, a, b, c, m1.w, 10, 0x432aff97u)
  STEP(MIX_4, c, d, a, b, m3.z, 15, 0xab9423a7u) STEP(MIX_4, b, c, d, a, m1.y, 21, 0xfc93a039u)
  STEP(MIX_4, a, b, c, d, m3.x, 6, 0x655b59c3u) STEP(MIX_4, d, a, b, c, m0.w, 10, 0x8f0ccc92u)
  STEP(MIX_4, c, d, a, b, m2.z, 15, 0xffeff47du) STEP(MIX_4, b, c, d, a, m0.y, 21, 0x85845dd1u)
  STEP(MIX_4, a, b, c, d, m2.x, 6, 0x6fa87e4fu) STEP(MIX_4, d, a, b, c, m3.w, 10, 0xfe2ce6e0u)
  STEP(MIX_4, c, d, a, b, m1.z, 15, 0xa3014314u) STEP(MIX_4, b, c, d, a, m3.y, 21, 0x4e0811a1u)
  STEP(MIX_4, a, b, c, d, m1.x, 6, 0xf7537e82u) STEP(MIX_4, d, a, b, c, m2.w, 10, 0xbd3af235u)
  STEP(MIX_4, c, d, a, b, m0.z, 15, 0x2ad7d2bbu) STEP(MIX_4, b, c, d, a, m2.y, 21, 0xeb86d391u)
  return uvec4(a, b, c, d) + uvec4(0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u);
}

// The digest of the six words: 24 bytes, the end mark, the length in bits.
uvec4 random_words(uint pixel, uint frame, uint ray, uint block) {
  return md5_block(uvec4(pixel, frame, ray, block), uvec4(u_random.xy, 0x80u, 0u), uvec4(0u), uvec4(0u, 0u, 192u, 0u));
}
#endif

#ifdef RANDOM_TEXTURE
// The paper's: an image of noise, a layer for each frame. A pixel starts at its own number and goes on by an odd stride
// for each (ray, block), so it reads no texel twice; another pixel may read the same texel for another block.
#define NOISE_STRIDE 0x9e3779b1u
uniform sampler2D u_noise;

uint noise_place(uint pixel, uint ray, uint block) {
  uint which = (ray - 1u) + 63u * block;
  return (pixel + which * NOISE_STRIDE) & uint(u_random.z - 1);
}

vec4 random_block(uint pixel, uint frame, uint ray, uint block) {
  uint layer = frame - uint(u_random.w);
  uint at = layer * uint(u_random.z) + noise_place(pixel, ray, block);
  uint width = uint(textureSize(u_noise, 0).x);
  return texelFetch(u_noise, ivec2(at % width, at / width), 0);
}
#else
// The upper 24 bits of each word.
vec4 random_block(uint pixel, uint frame, uint ray, uint block) {
  return vec4(random_words(pixel, frame, ray, block) >> 8u) * 5.9604644775390625e-8;
}
#endif
