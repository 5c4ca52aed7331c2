// Renders one picture after the other as a page does, each from the texts of a student.
"use strict";
live.film = async (chapter, scene, words, texts, size, samples) => {
    const {Renderer, Rendering} = live.rendering, {unpackWords} = live.loading;
    live.film.renderer ??= new Renderer(document.querySelector("canvas"));
    const {renderer} = live.film, parameters = Uint32Array.from(words);
    const place = renderer.layout.offsetOf("RenderParameters", "image_size");
    parameters.set(size, place);
    scene.words ??= await unpackWords(scene.packed);
    const translated = live.glsl.translate({sources: {...live.sources, ...texts}, chapter, defines: scene.defines, scene});
    const linked = await renderer.compile(translated);
    const rendering = new Rendering(renderer, {translated, linked, scene, parameters, size});
    let film;
    await rendering.render({target: () => samples, look(latest) { film = latest; }});
    rendering.stop();
    return Array.from(film.sums, sum => sum / samples);
};
