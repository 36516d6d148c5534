// A worker with an instance of the module. Of the questions that wait only the last one counts.

export class Service {
    #worker;
    #onProgress;
    #compiled;
    #number = 0;
    #asked;
    #waiting;

    constructor(compiled, onProgress = () => {}) {
        this.#compiled = compiled;
        this.#onProgress = onProgress;
        this.#begin();
    }

    #begin() {
        const worker = new Worker(new URL("worker.js", document.baseURI), { type: "module" });
        worker.addEventListener("message", ({ data }) => this.#took(data));
        worker.addEventListener("error", (event) => this.#failed(worker, event.message));
        worker.postMessage({ kind: "start", compiled: this.#compiled, number: 0 });
        this.#worker = worker;
    }

    // A worker that failed, or whose file cannot be loaded, answers nothing more. The next question begins another one. To begin it here
    // would go on for ever while the file cannot be loaded.
    #failed(worker, message) {
        if (worker !== this.#worker) {
            return;
        }
        worker.terminate();
        this.#worker = undefined;
        this.#end({ fault: message || "the worker failed" });
    }

    #took(data) {
        if (data.kind === "progress") {
            this.#onProgress(data);
        } else if (data.number === this.#asked?.number) {
            this.#end(data.kind === "fault" ? { fault: data.cause } : data);
        }
    }

    #end(outcome) {
        const asked = this.#asked;
        this.#asked = undefined;
        asked?.done(outcome);
        const next = this.#waiting;
        this.#waiting = undefined;
        if (next) {
            this.#send(next);
        }
    }

    #send(question) {
        this.#number += 1;
        this.#asked = { number: this.#number, done: question.done };
        if (!this.#worker) {
            this.#begin();
        }
        this.#worker.postMessage({ ...question.message, number: this.#number });
    }

    get busy() {
        return this.#asked !== undefined;
    }

    // The answer; { stopped } if it was stopped or another question took its place, { fault } if the module failed.
    ask(message) {
        return new Promise((done) => {
            const question = { message, done };
            if (this.busy) {
                this.#waiting?.done({ stopped: true });
                this.#waiting = question;
            } else {
                this.#send(question);
            }
        });
    }

    // Ends the worker, and begins another one.
    stop() {
        this.#worker?.terminate();
        this.#begin();
        this.#end({ stopped: true });
    }
}
