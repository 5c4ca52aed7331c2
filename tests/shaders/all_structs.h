// Every struct of shaders/interface.h twice in a row, so that offsets, sizes and strides all show.
#ifndef ALL_STRUCTS_H
#define ALL_STRUCTS_H

struct AllStructs {
    Material materials[2];
    Instance instances[2];
    Camera cameras[2];
    RenderParameters render_parameters[2];
    DispatchParameters dispatch_parameters[2];
    FilmPixel film_pixels[2];
};

#endif
