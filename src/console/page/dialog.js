// One question at a time, in the page. The rest of the page waits behind it; STOP does not.

import { by_id, make, set_text } from './dom.js';
import { kStopped } from './stop.js';

/// Everything a question holds back. STOP and what others ask stand outside of them.
const kBehind = ['#who', '#band', 'main'];

export class Dialog {
  #element = by_id('dialog');
  #yes = by_id('dialog-yes');
  #no = by_id('dialog-no');
  #question = null;
  #focused = null;

  constructor(connection) {
    this.#yes.addEventListener('click', () => this.#close(true));
    this.#no.addEventListener('click', () => this.#close(false));
    this.#element.addEventListener('cancel', event => event.preventDefault());
    document.addEventListener(kStopped, () => this.#close(false));
    connection.on('state', state => this.#check(state));
    connection.on('closed', () => this.#close(false));
    this.connection = connection;
  }

  get open() { return this.#element.open; }

  /// `question`: title, lines, yes, no, and optionally `stale(state)`, which takes the question back, and `blocked(state)`,
  /// which says why the answer cannot be yes. Resolves to whether it was yes.
  ask(question) {
    this.#close(false);
    this.#question = question;
    this.#focused = document.activeElement;
    by_id('dialog-title').textContent = question.title;
    by_id('dialog-text').replaceChildren(...question.lines.filter(Boolean).map(text => make('p', { textContent: text })));
    this.#yes.textContent = question.yes;
    this.#no.textContent = question.no;
    this.#show(true);
    this.#check(this.connection.state);
    this.#no.focus();
    return new Promise(resolve => { question.resolve = resolve; });
  }

  #show(open) {
    by_id('scrim').hidden = !open;
    for (const selector of kBehind) document.querySelector(selector).inert = open;
    if (open) this.#element.show(); else this.#element.close();
  }

  #check(state) {
    if (!this.#question || !state) return;
    if (this.#question.stale?.(state)) return this.#close(false);
    const blocked = this.#question.blocked?.(state) ?? '';
    set_text(by_id('dialog-blocked'), blocked);
    this.#yes.disabled = !!blocked;
  }

  #close(answer) {
    if (!this.#question) return;
    const question = this.#question;
    this.#question = null;
    this.#show(false);
    this.#focused?.focus?.();
    question.resolve(answer);
  }
}
