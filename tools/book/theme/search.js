// Of up to three words a page must have all: otherwise the headings with "table" come before what is about the alias table.
function requireAllOfFew(query) {
    const words = query.split(/[\s()]+/).filter(word => word);
    return words.map(word => words.length <= 3 && /^\w/.test(word) ? `+${word}` : word).join(" ");
}

// A page that was opened from the disk may not start a Worker: there the search runs in a hidden frame of the page.
if (location.protocol === "file:") {
    window.Worker = class extends EventTarget {
        constructor(url) {
            super();
            const frame = document.createElement("iframe");
            frame.hidden = true;
            frame.answer = data => this.dispatchEvent(new MessageEvent("message", {data}));
            frame.srcdoc = `<script>postMessage = data => frameElement.answer(data)</script><script src="${url}"></script>`;
            this.frame = new Promise(loaded => frame.addEventListener("load", () => loaded(frame)));
            document.head.append(frame);
        }

        postMessage(data) { this.frame.then(frame => frame.contentWindow.dispatchEvent(new MessageEvent("message", {data}))); }
    };
}
