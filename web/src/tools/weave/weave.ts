/** Computes the session's maps with other settings, and shows them next to the present ones. */
import { deleteWeave, startWeave } from '../../api/weaves';
import { fetchWeaves, type ListedWeave } from '../../api/weave_list';
import { el } from '../../dom';
import { poll, type Pace } from '../../poll';
import type { ToolContext } from '../context';
import { button } from '../fields';
import { NewestOnly } from '../newest_only';
import { Outcome } from '../outcome';
import type { Tool } from '../toolbox';
import type { Comparison } from './comparison';
import { DifferenceView } from './difference_view';
import { SettingsForm } from './settings_form';
import { isUnfinished, WeaveRows } from './weave_rows';

const kBusyPace: Pace = { visibleMs: 300, hiddenMs: 2_000 };
const kIdlePace: Pace = { visibleMs: 3_000, hiddenMs: 15_000 };

/** @param comparison continues when the tool is closed, so that the user can look at the map */
export function weaveTool(context: ToolContext, comparison: Comparison): Tool {
  return {
    id: 'weave',
    title: 'Re-weave and compare',
    key: 'w',
    does: 'computes the maps again with other settings',
    icon: 'M2.5 4.5h4l3 7h4M2.5 11.5h4l3-7h4M11.5 2.5l2 2-2 2M11.5 9.5l2 2-2 2',
    open: (card, signal) => void new WeaveCard(context, comparison, card, signal),
  };
}

class WeaveCard {
  private readonly form: SettingsForm;
  private readonly rows: WeaveRows;
  private readonly difference: DifferenceView;
  private readonly outcome = new Outcome();
  private readonly task: NewestOnly;
  private readonly end = button('End the comparison', () => this.endComparison());
  private polling = new AbortController();
  /** The weave that was requested here: shown as soon as it is done. */
  private wanted: string | null = null;
  /** The last request for the list failed. */
  private troubled = false;

  constructor(
    private readonly context: ToolContext,
    private readonly comparison: Comparison,
    card: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    this.form = new SettingsForm(context.session()?.config ?? {});
    this.rows = new WeaveRows(() => context.session()?.config ?? {}, {
      show: (weave) => this.show(weave),
      remove: (weave) => this.remove(weave),
    });
    this.difference = new DifferenceView(context, signal, this.outcome);
    this.task = new NewestOnly(
      signal,
      () => {},
      (error) => this.outcome.complain(error),
    );
    this.fill(card);
    signal.addEventListener('abort', () => this.polling.abort());
    this.followSides();
    this.markShown();
    this.watch(kIdlePace);
  }

  private fill(card: HTMLElement): void {
    const form = el(
      'form',
      { class: 'tool-form' },
      this.form.element,
      el(
        'div',
        { class: 'tool-buttons' },
        el('button', { class: 'tool-button primary' }, 'Weave'),
        button('Session settings', () => this.form.reset()),
      ),
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.start();
    });
    card.append(this.outcome.element, this.end, this.difference.element, form, this.rows.element);
  }

  /** Another layer, or another moment, has another difference. */
  private followSides(): void {
    const { picture } = this.context;
    const sides = (): string => `${picture.main?.layer ?? ''} ${picture.main?.source.weave ?? ''}`;
    let seen = sides();
    picture.listen(() => {
      if (sides() === seen) return;
      seen = sides();
      this.markShown();
    }, this.signal);
  }

  private start(): void {
    const session = this.context.session();
    if (!session) return;
    this.task.run(async (signal) => {
      this.outcome.report('The server computes the maps\u2026');
      const weave = await startWeave(session.name, this.form.changes, signal);
      this.wanted = weave.id;
      this.watch(kBusyPace);
    });
  }

  /** Polls the list, more often while a weave is in progress. */
  private watch(pace: Pace): void {
    this.polling.abort();
    this.polling = new AbortController();
    const session = this.context.session();
    if (!session || this.signal.aborted) return;
    const { signal } = this.polling;
    void poll(
      async () => {
        const weaves = await fetchWeaves(session.name, signal);
        if (!signal.aborted) this.update(weaves, pace);
      },
      pace,
      signal,
      (error) => this.settle(error),
    );
  }

  /** Reports that the list cannot be loaded, or can again. */
  private settle(error: unknown): void {
    if (error !== null) this.outcome.complain(error);
    else if (this.troubled) this.outcome.report(this.wanted === null ? '' : 'The server computes the maps\u2026');
    this.troubled = error !== null;
  }

  private update(weaves: ListedWeave[], pace: Pace): void {
    this.rows.show(weaves.filter((weave) => !this.isMoment(weave) || weave.id === this.comparison.weave?.id));
    const wanted = weaves.find(({ id }) => id === this.wanted);
    if (wanted?.state === 'done') this.show(wanted);
    else if (wanted && !isUnfinished(wanted)) this.fail(wanted);
    else if (!wanted && this.wanted !== null) this.lose();
    const wantedPace = weaves.some(isUnfinished) ? kBusyPace : kIdlePace;
    if (wantedPace !== pace) this.watch(wantedPace);
  }

  /** Weaves of earlier times are excluded: playback makes hundreds of them, and they have the session's settings. */
  private isMoment({ follows, config }: ListedWeave): boolean {
    const own = this.context.session()?.config ?? {};
    return !follows && Object.entries(config).every(([name, value]) => own[name] === value);
  }

  private show(weave: ListedWeave): void {
    const session = this.context.session();
    if (!session) return;
    this.wanted = null;
    this.comparison.show(session, weave, (error) => this.outcome.complain(error));
    this.outcome.report('Shown right of the line; drag it to compare.');
    this.markShown();
  }

  /** The server restarted, or dropped the weave for others. */
  private lose(): void {
    this.wanted = null;
    this.outcome.complain(new Error('The server no longer has this weave; start it again'));
  }

  private fail({ state, reason }: ListedWeave): void {
    this.wanted = null;
    this.outcome.complain(new Error(reason === '' ? `The weave was ${state}` : reason));
  }

  private remove(weave: ListedWeave): void {
    const session = this.context.session();
    if (!session) return;
    if (weave.id === this.comparison.weave?.id) this.endComparison();
    if (weave.id === this.wanted) this.wanted = null;
    this.task.run(async (signal) => {
      await deleteWeave(session.name, weave.id, signal);
      this.outcome.report(isUnfinished(weave) ? 'Cancelled.' : 'Deleted.');
      this.watch(kBusyPace);
    });
  }

  private endComparison(): void {
    this.comparison.end();
    this.outcome.report('');
    this.markShown();
  }

  private markShown(): void {
    const shown = this.comparison.weave?.id ?? null;
    this.rows.mark(shown);
    this.end.hidden = shown === null;
    this.difference.compare(shown);
  }
}
