// The check of a page: verdicts on the scenes of ./lab check, then the facts that its experiments show.
"use strict";

live.check = (() => {
    const {element} = live, FIRST_VERDICT = 16, REPEATS = 3;

    const table = rows =>
        element("table", {}, ...rows.map(row => element("tr", {}, ...row.map(cell => element("td", {}, cell)))));

    // The names of the scenes and their verdicts, one after the other; null if the reader does something else.
    async function verdicts(frame) {
        const {checked, pictures, samples} = frame.about, rows = [], enough = Math.max(samples, FIRST_VERDICT);
        for (const name of checked) {
            const picture = pictures.find(p => p.name === name);
            if (!picture) {
                rows.push([name, "is too large for a page: ./lab check renders it"]);
                continue;
            }
            frame.controls.scene.value = pictures.indexOf(picture);
            let last;
            const target = () => last?.verdict?.samples >= enough ? 0 : live.Picture.MOST_SAMPLES;
            const done = await frame.picture.render(picture, target, (film, reference, verdict) => {
                if (!film.rays) throw new Error("the shader traces no ray: there is nothing to check");
                last = verdict;
                frame.show(film, reference, verdict);
            });
            if (!done) return null;
            rows.push([name, last.text]);
            frame.results.replaceChildren(table(rows));
        }
        return rows;
    }

    // What the shader shows at a point of an experiment. What looks wrong is rendered again with other random numbers.
    async function sightOf(frame, experiment, point, {scenes, rules}, pace) {
        const sights = [];
        const {picture} = frame, place = picture.renderer.layout.offsetOf("RenderParameters", "seed_key");
        const isWrong = () => {
            const shown = experiment.points.map(each => each === point ? live.facts.together(sights) : each);
            return !live.facts.fact(experiment, shown, rules).isRight;
        };
        do {
            const parameters = Uint32Array.from(point.parameters);
            parameters[place] ^= Math.imul(sights.length, 0x9e3779b9);
            const job = {scene: scenes[point.scene], parameters, options: point.options};
            const state = await picture.prepare(job, frame.editor.sources), {rendering} = state;
            picture.renderings = [state];
            let film;
            const look = latest => {
                picture.checkLoops(latest, state);
                film = latest;
            };
            const done = await rendering.render({target: () => point.samples, isPaused: () => document.hidden, look}, pace);
            rendering.stop();
            if (!done) return null;
            sights.push(live.facts.look(film, point.channel));
        } while (sights.length < REPEATS && isWrong());
        return live.facts.together(sights);
    }

    // The facts of all experiments whose conditions are met; null if the reader does something else.
    async function factsOf(frame) {
        const known = await live.loading.loadData(frame.root.dataset.folder, `experiments_${frame.chapter}`), facts = {};
        const {picture, picture: {turn, numbers}} = frame;
        const {experiments, rules} = known, pace = {rows: 8, step: 1};
        for (const [i, experiment] of experiments.entries()) {
            if (!Object.entries(experiment.when).every(([name, isRight]) => !(name in facts) || facts[name].isRight === isRight))
                continue;
            const sights = [];
            for (const point of experiment.points) {
                numbers.textContent = `experiment ${i + 1} of ${experiments.length}: ${experiment.subject}`;
                sights.push(await sightOf(frame, experiment, point, known, pace));
                if (turn !== picture.turn || !sights.at(-1)) return null;
            }
            facts[experiment.name] = {experiment, ...live.facts.fact(experiment, sights, rules)};
        }
        numbers.textContent = "";
        return Object.values(facts);
    }

    return async frame => {
        const rows = await verdicts(frame);
        if (!rows) return;
        const tell = (...texts) =>
            frame.results.replaceChildren(element("p", {}, element("strong", {}, texts[0]), ...texts.slice(1)), table(rows));
        const isBiased = rows.some(([, text]) => text.startsWith("biased"));
        const headline =
            isBiased ? "Biased: the estimator is wrong on a scene." : "Correct on all scenes, as far as these samples tell.";
        tell(headline, " The experiments follow …");
        let facts;
        try {
            facts = await factsOf(frame);
        } catch (error) {
            tell(headline, " The experiments could not be rendered.");
            throw error;
        }
        if (!facts) return;
        const wrong = facts.filter(({isRight}) => !isRight);
        const subjects = those => [...new Set(those.map(({experiment}) => experiment.subject))];
        const right = subjects(facts.filter(({isRight}) => isRight)).filter(subject => !subjects(wrong).includes(subject));
        tell(
            isBiased || !wrong.length ? headline : "Biased: the scenes do not show it, but experiments do.",
            ` ${wrong.length} of ${facts.length} experiments show something wrong${wrong.length ? ":" : "."}`);
        frame.results.append(element("ul", {class: "live-facts"}, ...wrong.map(({sentence}) => element("li", {}, sentence))));
        if (wrong.length && right.length) frame.results.append(element("p", {}, `Right: ${right.join("; ")}.`));
        const more = "./lab check says more: laws that a mistake follows, how noisy the estimator is, and what to look at next.";
        frame.results.append(element("p", {}, more));
    };
})();
