// Looks at the page from within: what is there, what is drawn, what overlaps. The test reads the answer from the document.
const rect = (element) => element.getBoundingClientRect();
const overlap = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
const inside = (a, b) => a.left >= b.left - 1 && a.right <= b.right + 1 && a.top >= b.top - 1 && a.bottom <= b.bottom + 1;
const charts = [...document.querySelectorAll("svg.chart")];
const faults = [];
for (const chart of charts) {
    const texts = [...chart.querySelectorAll("text")].filter((text) => text.textContent);
    const name = chart.querySelector("title").textContent;
    for (const [i, text] of texts.entries()) {
        if (!inside(rect(text), rect(chart))) faults.push(`${name}: "${text.textContent}" leaves the chart`);
        for (const other of texts.slice(i + 1)) {
            if (overlap(rect(text), rect(other))) faults.push(`${name}: "${text.textContent}" and "${other.textContent}" overlap`);
        }
    }
    if (rect(chart).width < 100 || !chart.querySelector("path.line")) faults.push(`${name}: nothing drawn`);
}
const images = [...document.images];
for (const image of images) {
    if (!image.complete || image.naturalWidth === 0 || rect(image).width < 20) faults.push(`no picture: ${image.alt}`);
}
for (const block of document.querySelectorAll("body > *, main > *")) {
    if (rect(block).right > document.documentElement.clientWidth + 1) faults.push(`too wide: ${block.textContent.slice(0, 60)}`);
}
const pre = document.createElement("pre");
pre.id = "seen";
pre.textContent = JSON.stringify({
    width: document.documentElement.clientWidth,
    background: getComputedStyle(document.body).backgroundColor,
    sections: [...document.querySelectorAll("h2")].map((heading) => heading.textContent),
    charts: charts.length,
    images: images.length,
    faults,
});
document.body.append(pre);
