// Renders the first picture of each chapter as its page does, and sends the films to the server of firefox_test.py.
"use strict";
(async () => {
    const {Renderer, Rendering} = live.rendering, {loadData, unpackWords} = live.loading, samples = 16;
    const send = (path, body) => fetch(path, {method: "POST", body});
    try {
        const renderer = new Renderer(document.querySelector("canvas"));
        for (const [chapter, {pictures: [picture]}] of Object.entries(live.chapters)) {
            const scene = await loadData("/live/", picture.scene), parameters = Uint32Array.from(picture.parameters);
            const {sources} = live;
            scene.words ??= await unpackWords(scene.packed);
            const place = renderer.layout.offsetOf("RenderParameters", "image_size");
            const size = [parameters[place], parameters[place + 1]];
            const translated = live.glsl.translate({sources, chapter, defines: scene.defines, scene});
            let film;
            const rendering =
                new Rendering(renderer, {translated, linked: await renderer.compile(translated), scene, parameters, size});
            await rendering.render({target: () => samples, look(latest) { film = latest; }});
            rendering.stop();
            await send(`/film/${chapter}/${picture.name}/${size.join("x")}`, Float32Array.from(film.sums, sum => sum / samples));
        }
        await send("/done", renderer.device.name);
    } catch (error) { await send("/failed", String(error.stack ?? error)); }
})();
