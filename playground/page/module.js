// The WebAssembly module with its functions as JavaScript: src/edge.rs says who owns which memory.

export class Module {
    // `compiled` is a WebAssembly.Module. `goesOn(fraction, steps)` is asked after each step of a run; false ends it.
    static async of(compiled, goesOn = () => true) {
        const module = new Module();
        const page = {
            goes_on: (fraction, steps) => (goesOn(fraction, steps) ? 1 : 0),
            panicked: (text, length) => {
                module.fault = module.#decoded(text, length);
            },
        };
        const { exports } = await WebAssembly.instantiate(compiled, { page });
        module.exports = exports;
        exports.playground_begin();
        return module;
    }

    // The text of a panic. After it, or after any other error of a call, the module must not be used again.
    fault = undefined;
    #ran = 0;

    #bytes(place, length) {
        // the memory is another buffer after it has grown
        return new Uint8Array(this.exports.memory.buffer, place, length);
    }

    #decoded(place, length) {
        return new TextDecoder().decode(this.#bytes(place, length));
    }

    #call(work, request) {
        const bytes = new TextEncoder().encode(JSON.stringify(request));
        const room = this.exports.playground_allocate(bytes.length);
        this.#bytes(room, bytes.length).set(bytes);
        const answer = work(room, bytes.length);
        this.exports.playground_release(room, bytes.length);
        return answer;
    }

    #text(answer) {
        return this.#decoded(this.exports.playground_text(answer), this.exports.playground_text_length(answer));
    }

    // The answer of src/check.rs.
    check(request) {
        const answer = this.#call(this.exports.playground_check, request);
        const found = JSON.parse(this.#text(answer));
        this.exports.playground_release_answer(answer);
        return found;
    }

    // The answer of src/run.rs, and the numbers of its columns.
    run(request) {
        this.exports.playground_release_answer(this.#ran);
        this.#ran = 0;
        this.#ran = this.#call(this.exports.playground_run, request);
        const first = this.exports.playground_numbers(this.#ran);
        const count = this.exports.playground_numbers_length(this.#ran);
        // a copy: the next call may move the memory
        const numbers = count === 0 ? new Float64Array() : new Float64Array(this.exports.memory.buffer, first, count).slice();
        return { answer: JSON.parse(this.#text(this.#ran)), numbers };
    }

    // The page of the last run: HTML, or { refused }.
    report() {
        const answer = this.exports.playground_page(this.#ran);
        const text = this.#text(answer);
        this.exports.playground_release_answer(answer);
        return text.startsWith("{") ? JSON.parse(text) : text;
    }
}

// The numbers of a column, of the answer of a run.
export const numbersOf = (column, numbers) => numbers.subarray(column.first, column.first + column.count);
