/** The user's settings, stored by the browser for the next visit. */

export const kSchemes = ['auto', 'light', 'dark'] as const;
export const kPalettes = ['standard', 'safe'] as const;

export interface Settings {
  /** auto: the system's scheme. */
  scheme: (typeof kSchemes)[number];
  /** safe: colours that people with any colour vision can distinguish. */
  palette: (typeof kPalettes)[number];
  robots: boolean;
  trails: boolean;
  points: boolean;
  frontiers: boolean;
  landmarks: boolean;
  /** Keyframes and the matches between them. */
  poseGraph: boolean;
  /** Goals and paths of the robots. */
  goals: boolean;
  /** A grid of round lengths, with the map's origin and axes. */
  grid: boolean;
  /** HIMM counters as numbers. */
  counters: boolean;
  /** Whether single-key shortcuts are on. */
  keys: boolean;
}

const kSwitches = [
  ...(['robots', 'trails', 'points', 'goals', 'frontiers', 'landmarks'] as const),
  ...(['poseGraph', 'grid', 'counters', 'keys'] as const),
] as const;

const kKey = 'scanloom';
const kDefaults: Settings = {
  scheme: 'auto',
  palette: 'standard',
  robots: true,
  trails: true,
  points: true,
  frontiers: false,
  landmarks: false,
  poseGraph: false,
  goals: true,
  grid: false,
  counters: false,
  keys: true,
};

export class SettingsStore {
  private settings = read();
  private readonly listeners: ((settings: Settings) => void)[] = [];

  constructor() {
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.notify());
    this.apply();
  }

  get(): Settings {
    return this.settings;
  }

  change(change: Partial<Settings>): void {
    this.settings = { ...this.settings, ...change };
    try {
      localStorage.setItem(kKey, JSON.stringify(this.settings));
    } catch {
      // Without storage, the settings last until the page is closed.
    }
    this.notify();
  }

  /** Calls the listener after every change, also of the system's colour scheme. */
  listen(listener: (settings: Settings) => void): void {
    this.listeners.push(listener);
  }

  private notify(): void {
    this.apply();
    for (const listener of this.listeners) listener(this.settings);
  }

  /** The style sheet's colours depend on two attributes. */
  private apply(): void {
    const { scheme, palette } = this.settings;
    const dark = scheme === 'dark' || (scheme === 'auto' && matchMedia('(prefers-color-scheme: dark)').matches);
    document.documentElement.dataset['scheme'] = dark ? 'dark' : 'light';
    document.documentElement.dataset['palette'] = palette;
  }
}

/** Invalid values are replaced by the defaults. */
function read(): Settings {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(kKey) ?? '{}');
    return typeof kept === 'object' && kept !== null ? valid(kept as Record<string, unknown>) : kDefaults;
  } catch {
    return kDefaults;
  }
}

function valid(kept: Record<string, unknown>): Settings {
  const settings: Settings = { ...kDefaults };
  for (const key of kSwitches) {
    const value = kept[key];
    if (typeof value === 'boolean') settings[key] = value;
  }
  settings.scheme = kSchemes.find((each) => each === kept['scheme']) ?? kDefaults.scheme;
  settings.palette = kPalettes.find((each) => each === kept['palette']) ?? kDefaults.palette;
  return settings;
}
