// The files of a chapter that a reader may edit: tabs over a text field. The texts stay in the browser's storage.
"use strict";
var live = globalThis.live ?? {};
globalThis.live = live;

// An element with attributes and children; attributes that are functions become event handlers.
live.element = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes))
        if (typeof value === "function") element.addEventListener(key, value); else if (value !== undefined) element.setAttribute(key, value);
    element.append(...children);
    return element;
};

live.Editor = (() => {
    const { element } = live, LONGEST = 200_000;  // characters; the longest shader of the course has 4,000
    const keyOf = path => `path tracing lab: ${path}`;

    // Browsers may forbid storage, and it may be full.
    function store(path, text) {
        try {
            if (text === undefined) localStorage.removeItem(keyOf(path)); else localStorage.setItem(keyOf(path), text);
            return true;
        } catch { return false; }
    }
    function stored(path) {
        try { return localStorage.getItem(keyOf(path)); } catch { return null; }
    }

    // The files that a chapter is made of: that of its lesson, its estimator, and what these include from chapters/.
    function filesOf(chapter) {
        const estimator = `chapters/${chapter}/path_trace.glsl`;
        const files = [...new Set([live.chapters[chapter].exercise?.file ?? estimator, estimator])];
        const own = Object.keys(live.sources).filter(path => path.startsWith(`chapters/${chapter}/`) && !files.includes(path));
        files.push(...own.sort());
        for (const file of files)
            for (const [, name] of live.sources[file].matchAll(/^#include "([^"]*)"/gm)) {
                const path = [file.replace(/[^/]*$/, ""), "chapters/"].map(folder => folder + name).find(p => p in live.sources);
                if (path && !files.includes(path)) files.push(path);
            }
        return files.filter(file => !/^#include "[^"]*"\s*$/.test(live.sources[file]));  // not those that only name another
    }

    return class Editor {
        // Calls changed() after each edit, and say(text) for what the reader should know.
        constructor(chapter, changed, say, keepsTexts) {
            Object.assign(this, { chapter, changed, say, keepsTexts });
            this.files = filesOf(chapter);
            this.texts = {};
            for (const file of this.files) this.texts[file] = (keepsTexts ? stored(file) : null) ?? live.sources[file];
            this.field = element("textarea", { spellcheck: "false", autocapitalize: "off", autocomplete: "off", wrap: "off", rows: "24",
                                               "aria-label": "the chapter's shader", input: () => this.edit(this.field.value) });
            this.tabs = element("div", { role: "tablist", "aria-label": "files of the chapter", class: "live-tabs", keydown: event => this.key(event) });
            this.error = element("div", { class: "live-error", role: "alert" });
            this.root = element("div", { class: "live-editor" }, this.tabs, this.field, this.error);
            this.open(this.files[0]);
            addEventListener("storage", event => {
                if (this.files.some(file => keyOf(file) === event.key)) say("Another tab has changed this text: reload the page to see it.");
            });
        }

        key(event) {
            const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
            if (!step) return;
            this.open(this.files.at((this.files.indexOf(this.file) + step) % this.files.length));
            this.tabs.querySelector("[aria-selected=true]").focus();
        }

        get sources() { return { ...live.sources, ...this.texts }; }
        get edited() { return this.files.filter(file => this.texts[file] !== live.sources[file]); }
        get tooLong() { return this.files.find(file => this.texts[file].length > LONGEST); }

        open(file) {
            this.file = file;
            this.field.value = this.texts[file];
            this.tabs.replaceChildren(...this.files.map(path => element("button", {
                type: "button", role: "tab", "aria-selected": String(path === file), tabindex: path === file ? "0" : "-1", title: path,
                click: () => this.open(path)
            }, path.replace(`chapters/${this.chapter}/`, "").replace("chapters/", "") + (this.texts[path] === live.sources[path] ? "" : " *"))));
        }

        edit(text, file = this.file) {
            const wasEdited = this.texts[file] !== live.sources[file];
            this.texts[file] = text;
            const isEdited = text !== live.sources[file];
            if (this.keepsTexts && !store(file, isEdited ? text : undefined)) this.say("The browser keeps no text of this page: download it before you leave.");
            if (file !== this.file || wasEdited !== isEdited || this.field.value !== text) {
                const { selectionStart, selectionEnd } = this.field;
                this.open(file);
                this.field.setSelectionRange(selectionStart, selectionEnd);
            }
            this.changed();
        }

        reset() {
            for (const file of this.edited) this.edit(live.sources[file], file);
        }

        // Shows a message of the form FILE:LINE: TEXT and selects the line, unless the reader is typing elsewhere.
        showError(message) {
            this.error.replaceChildren();
            if (!message) return;
            const match = /^(\S+):(\d+): /.exec(message), isOwn = match && this.files.includes(match[1]);
            this.error.append(!isOwn && match ? `${message} (in a file after yours: is a } missing in your text?)` : message);
            if (isOwn) this.error.append(" ", element("button", { type: "button", click: () => this.select(match[1], Number(match[2])) }, "Go to the line"));
        }

        select(file, line) {
            if (this.file !== file) this.open(file);
            const lines = this.field.value.split("\n"), start = lines.slice(0, line - 1).reduce((sum, l) => sum + l.length + 1, 0);
            this.field.focus();
            this.field.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
            this.field.scrollTop = this.field.scrollHeight * Math.max(0, line - 6) / lines.length;
        }

        download() {
            const url = URL.createObjectURL(new Blob([this.texts[this.file]], { type: "text/plain" }));
            element("a", { href: url, download: this.file.replace(/.*\//, "") }).click();
            setTimeout(() => URL.revokeObjectURL(url), 1000);
        }

        openFile() {
            element("input", { type: "file", accept: ".glsl,.txt", change: async event => {
                const [file] = event.target.files;
                if (!file) return;
                const bytes = new Uint8Array(await file.arrayBuffer());
                let text;
                // As project.py reads them: an editor may have saved the encoding of Windows.
                try { text = new TextDecoder("utf-8", { fatal: true }).decode(bytes); } catch { text = new TextDecoder("windows-1252").decode(bytes); }
                this.edit(text.replace(/\r\n?/g, "\n"), this.files.find(path => path.endsWith(`/${file.name}`)) ?? this.file);
            } }).click();
        }

        // The address of this page with the edited texts in its fragment, which browsers send to nobody.
        async link() {
            const texts = Object.fromEntries(this.edited.map(file => [file, this.texts[file]]));
            const packed = new Blob([JSON.stringify(texts)]).stream().pipeThrough(new CompressionStream("gzip"));
            const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
            const code = btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_");
            return `${location.href.split("#")[0]}#live=${code}`;
        }

        async readLink() {
            const code = this.keepsTexts ? /^#live=([\w=-]+)$/.exec(location.hash)?.[1] : null;
            if (!code) return;
            try {
                const bytes = await live.rendering.unpack(code.replaceAll("-", "+").replaceAll("_", "/"));
                const texts = JSON.parse(new TextDecoder().decode(bytes));
                const files = this.files.filter(file => typeof texts[file] === "string");
                for (const file of files) this.texts[file] = texts[file];
                if (files.length) this.open(files[0]);
                this.say("This text comes from a link. Your own is kept until you edit this one.");
            } catch { this.say("The link is damaged: here is the chapter's own text."); }
        }
    };
})();
