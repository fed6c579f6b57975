/** A dialog with a form and its request; it reports errors itself and stays open after them. */
import { MalformedAnswer } from '../api/decode';
import { Refused, Unreachable } from '../api/http';
import { el, setText } from '../dom';

export interface FormDialogTexts {
  title: string;
  /** Label of the submit button. */
  submit: string;
  /** Its label during the request. */
  busy: string;
  /** The action cannot be undone. */
  destructive?: boolean;
}

let made = 0;

export class FormDialog {
  readonly element: HTMLDialogElement;
  readonly cancel: HTMLButtonElement;
  private readonly submit: HTMLButtonElement;
  private readonly failure: HTMLElement;
  private leave = new AbortController();

  /** @param run sends the request; the dialog closes when it succeeds, and closing the dialog aborts it */
  constructor(
    private readonly texts: FormDialogTexts,
    content: (Node | string)[],
    private readonly run: (signal: AbortSignal) => Promise<void>,
  ) {
    const id = `dialog-${++made}`;
    this.failure = el('p', { class: 'dialog-failure', role: 'alert' });
    this.cancel = el('button', { type: 'button' }, 'Cancel');
    this.submit = el('button', { type: 'submit', class: texts.destructive ? 'destructive' : 'primary' }, texts.submit);
    const buttons = el('div', { class: 'dialog-buttons' }, this.cancel, this.submit);
    const form = el('form', {}, el('h2', { id }, texts.title), ...content, this.failure, buttons);
    this.element = el('dialog', { class: 'dialog', 'aria-labelledby': id }, form);
    this.cancel.addEventListener('click', () => this.element.close());
    this.element.addEventListener('close', () => this.leave.abort());
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.attempt();
    });
    document.body.append(this.element);
  }

  /** @param focus the most likely first input; never a button whose action cannot be undone */
  open(focus: HTMLElement): void {
    this.settle('');
    this.element.showModal();
    focus.focus();
  }

  private async attempt(): Promise<void> {
    if (this.submit.getAttribute('aria-disabled') === 'true') return;
    this.leave = new AbortController();
    const { signal } = this.leave;
    setText(this.failure, '');
    setText(this.submit, this.texts.busy);
    // A disabled button would lose the focus.
    this.submit.setAttribute('aria-disabled', 'true');
    try {
      await this.run(signal);
      if (!signal.aborted) this.element.close();
    } catch (error) {
      if (!signal.aborted) this.settle(sentenceOf(error));
    }
  }

  private settle(failure: string): void {
    setText(this.failure, failure);
    setText(this.submit, this.texts.submit);
    this.submit.removeAttribute('aria-disabled');
  }
}

function sentenceOf(error: unknown): string {
  if (error instanceof Unreachable) return 'Offline: the server does not answer. Try again when it is online.';
  if (error instanceof Refused) return `The server refuses: ${error.message}.`;
  if (error instanceof MalformedAnswer) return `The server\u2019s answer cannot be read: ${error.message}.`;
  return `Something in this page failed: ${String(error)}.`;
}
