/** Sign-in and sign-out: asks for a token when the server requires one. The dialog is the only message about it. */
import { onUnauthorized } from './api/http';
import { fetchLogin, signIn, signOut, type Login } from './api/login';
import { el, setText } from './dom';
import { retryNow } from './poll';
import { FormDialog } from './sessions/form_dialog';

export class SignIn {
  private readonly dialog: FormDialog;
  private readonly secret: HTMLInputElement;
  private readonly name = el('span', { dir: 'auto' });
  private readonly reason = el('p');
  private wasSignedIn = false;

  /** @param place shows the name of the token; hidden where the server requires none */
  constructor(private readonly place: HTMLElement) {
    this.secret = el('input', {
      id: 'token',
      type: 'password',
      required: '',
      autocomplete: 'current-password',
      autocapitalize: 'off',
      spellcheck: 'false',
      'aria-describedby': 'token-rule',
    });
    this.dialog = new FormDialog(
      { title: 'Sign in', submit: 'Sign in', busy: 'Signing in\u2026' },
      [
        this.reason,
        el('label', { for: 'token' }, 'Token'),
        this.secret,
        el('p', { id: 'token-rule', class: 'quiet' }, 'The operator of the server gives you one.'),
      ],
      (signal) => this.attempt(signal),
    );
    this.dialog.element.classList.add('sign-in');
    // Without a token there is nothing to return to.
    this.dialog.cancel.remove();
    this.dialog.element.addEventListener('cancel', (event) => event.preventDefault());
    const out = el('button', { type: 'button', class: 'wide-button' }, 'Sign out');
    out.addEventListener('click', () => void this.leave());
    place.replaceChildren(el('p', { class: 'quiet' }, 'Signed in with the token ', this.name, '.'), out);
  }

  /** From now on the dialog opens whenever the server requires a token. The open session stays open behind it. */
  async run(): Promise<void> {
    onUnauthorized(() => this.prompt());
    // The next request reports errors.
    const login = await fetchLogin(new AbortController().signal).catch(() => null);
    if (login) this.show(login);
  }

  private prompt(): void {
    if (this.dialog.element.open) return;
    this.secret.value = '';
    setText(
      this.reason,
      this.wasSignedIn ? 'Your session has expired. Sign in again.' : 'This server requires a token.',
    );
    this.dialog.open(this.secret);
  }

  private async attempt(signal: AbortSignal): Promise<void> {
    const login = await signIn(this.secret.value.trim(), signal);
    this.secret.value = '';
    this.show(login);
    retryNow();
  }

  private show({ token }: Login): void {
    this.wasSignedIn ||= token !== null;
    this.place.hidden = token === null;
    setText(this.name, token === null ? '' : `${token.name} (${token.role})`);
  }

  /** A reload discards everything that was shown. */
  private async leave(): Promise<void> {
    await signOut(new AbortController().signal).catch(() => {});
    location.reload();
  }
}
