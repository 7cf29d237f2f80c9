// SPDX-License-Identifier: MIT
// Which sample a pixel of a rendering pass works on. A batch is a tile of the picture in some frames: the sample of lane
// l of pixel (x, y) of the tile in block b stands at (x * lanes + l, b * tile height + y), and is of frame
// first + b * lanes + l.

uniform ivec4 u_tile;    // first pixel of the tile, its height, lanes
uniform ivec4 u_sample;  // first frame, number of the ray (SEMANTICS 6.1), light, width of the picture

ivec2 item() { return ivec2(gl_FragCoord.xy); }
ivec2 picture_pixel() { return u_tile.xy + ivec2(item().x / u_tile.w, item().y % u_tile.z); }
uint pixel_number() { return uint(picture_pixel().y * u_sample.w + picture_pixel().x); }
uint frame_number() { return uint(u_sample.x + item().y / u_tile.z * u_tile.w + item().x % u_tile.w); }
