// Texts in the fragment of a link: compressed, in letters that an address may have. No server sees them.

async function through(stream, bytes) {
    const changed = new Blob([bytes]).stream().pipeThrough(stream);
    return new Uint8Array(await new Response(changed).arrayBuffer());
}

// `#t=TEXT&f=NAME`; the name is that of an example, whose files the text may read.
export async function fragmentOf(text, name) {
    const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text));
    const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
    const packed = btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
    return `#t=${packed}&f=${encodeURIComponent(name)}`;
}

// Text and name of a fragment; undefined without a text, or with one that cannot be read.
export async function textOf(fragment) {
    const entries = new URLSearchParams(fragment.slice(1));
    const packed = entries.get("t");
    if (!packed) {
        return undefined;
    }
    try {
        const letters = atob(packed.replaceAll("-", "+").replaceAll("_", "/"));
        const bytes = await through(new DecompressionStream("deflate-raw"), Uint8Array.from(letters, (letter) => letter.charCodeAt(0)));
        return { text: new TextDecoder("utf-8", { fatal: true }).decode(bytes), name: entries.get("f") ?? "" };
    } catch {
        return undefined;
    }
}
