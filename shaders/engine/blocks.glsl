// Blocks of pixels, numbered row by row: neighbouring pixels are computed together.

// The position of a pixel of a block; `index` counts row by row. It may lie outside the image at the right and lower edges.
uvec2 get_pixel_position(uint block, uint index, uvec2 image_size) {
    uint blocks_per_row = (image_size.x + BLOCK_WIDTH - 1u) / BLOCK_WIDTH;
    uvec2 corner = uvec2(block % blocks_per_row, block / blocks_per_row) * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
    return corner + uvec2(index % BLOCK_WIDTH, index / BLOCK_WIDTH);
}
