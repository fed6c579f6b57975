/** Shows a tool's state and errors, also to screen readers. */
import { MalformedAnswer } from '../api/decode';
import { Refused, Unreachable } from '../api/http';
import { el, setText } from '../dom';

export class Outcome {
  private readonly state = el('p', { role: 'status', class: 'tool-state' });
  private readonly trouble = el('p', { role: 'alert', class: 'tool-trouble' });
  readonly element = el('div', { class: 'tool-outcome' }, this.state, this.trouble);

  report(sentence: string): void {
    setText(this.trouble, '');
    setText(this.state, sentence);
  }

  complain(error: unknown): void {
    setText(this.state, '');
    setText(this.trouble, sentenceOf(error));
  }
}

/** Uses the server's message where there is one. */
export function sentenceOf(error: unknown): string {
  if (error instanceof Refused) return ended(error.message);
  if (error instanceof Unreachable) return ended(`Offline: ${error.message}`);
  if (error instanceof MalformedAnswer) return ended(`The server\u2019s answer cannot be read: ${error.message}`);
  return ended(error instanceof Error ? error.message : String(error));
}

function ended(text: string): string {
  return /[.!?]$/.test(text) ? text : `${text}.`;
}
