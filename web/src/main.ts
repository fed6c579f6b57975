/** Builds the page's parts and connects them; what each does is its own file's matter. */
import { fetchRobotPort, fetchSessions } from './api/api';
import type { DamagedSession, RobotPort, Session } from './api/types';
import { hashOfSession, hashWithLayer, layerOfHash, sessionOfHash } from './address';
import { byId, setText } from './dom';
import { Camera } from './map/camera';
import { createMap, MapView } from './map/map_view';
import { Keys } from './keys';
import { NewestSessions } from './newest_sessions';
import { Cursor } from './panel/cursor';
import { DisplayPanel } from './panel/display_panel';
import { Facts } from './panel/facts';
import { LayersPanel } from './panel/layers_panel';
import { Notice } from './panel/notice';
import { RobotList } from './panel/robot_list';
import { showScale } from './panel/scale_bar';
import { Status } from './panel/status';
import { SwipeHandle } from './panel/swipe_handle';
import { TimeBar } from './panel/time_bar';
import { Picture } from './picture';
import { poll, type Pace } from './poll';
import { SettingsStore } from './settings';
import type { ToolContext } from './tools/context';
import { coverageTool } from './tools/coverage';
import { exportTool } from './tools/export';
import { importTool } from './tools/import';
import { measureTool } from './tools/measure';
import { pathTool } from './tools/path';
import { Toolbox } from './tools/toolbox';
import { ServerCharts } from './charts/server_charts';
import { SessionPanel } from './sessions/session_panel';
import { readTheme } from './theme';
import { SessionHistory } from './time/history';
import { Comparison } from './tools/weave/comparison';
import { weaveTool } from './tools/weave/weave';
import { Viewer } from './viewer';
import './style/index.css';

const kSessionsPace: Pace = { visibleMs: 2_000, hiddenMs: 15_000 };

const settings = new SettingsStore();
const keys = new Keys();
const panelToggle = byId('panel-toggle', HTMLButtonElement);
const target = byId('map', HTMLElement);
const map = createMap(target);
const mapView = new MapView(map, readTheme());
const picture = new Picture(mapView);
const notice = new Notice(byId('notice', HTMLElement));
const status = new Status(byId('status', HTMLElement));
/** Sessions whose end this page has asked for. */
const ending = new Set<string>();
const sessionPanel = new SessionPanel(readTheme(), {
  created: ({ name }) => void (location.hash = hashOfSession(name)),
  wanted: () => setPanel(true),
  asked: (name) => void ending.add(name),
  kept: (name) => void ending.delete(name),
  deleted: (name) => leaveDeleted(name),
});
const serverCharts = new ServerCharts(byId('server-toggle', HTMLButtonElement), byId('server', HTMLElement));
const newest = new NewestSessions();
const robotList = new RobotList(
  byId('robots', HTMLElement),
  { pathLength: (robot) => viewer.pathLength(robot) },
  (robot) => follow(robot),
);
const camera = new Camera(map, target, (robot) => robotList.setFollowed(robot));
const cursor = new Cursor(map, target, {
  box: byId('cursor', HTMLElement),
  x: byId('cursor-x', HTMLElement),
  y: byId('cursor-y', HTMLElement),
  cell: byId('cursor-cell', HTMLElement),
  value: byId('cursor-value', HTMLElement),
  others: byId('cursor-others', HTMLElement),
  crosshair: byId('crosshair', HTMLElement),
});
const viewer: Viewer = new Viewer({
  map: mapView,
  picture,
  camera,
  cursor,
  facts: new Facts(byId('facts', HTMLElement)),
  robots: robotList,
  notice,
  status,
  settings,
  details: byId('details', HTMLElement),
  noRobots: byId('no-robots', HTMLElement),
  newest: (session) => {
    const known = newest.learn(session);
    sessionPanel.refresh(known);
    return known;
  },
  refresh: () => void refreshOnce(),
  endIsExpected: (name) => ending.has(name),
});
const toolbox = new Toolbox(
  {
    bar: byId('toolbar', HTMLElement),
    card: byId('tool', HTMLElement),
    title: byId('tool-title', HTMLElement),
    body: byId('tool-body', HTMLElement),
    close: byId('tool-close', HTMLButtonElement),
  },
  keys,
  () => viewer.session?.bounds != null,
);
let refreshing = false;
let robotPort: RobotPort | null = null;

function follow(robot: string | null): void {
  if (robot === null) camera.free();
  else camera.follow(robot);
}

/** Follows the page's address. */
function openChosen(): void {
  const name = sessionOfHash(location.hash);
  if (name === null) return;
  const layer = layerOfHash(location.hash);
  if (layer !== null) picture.change({ layer });
  document.title = `${name} \u2013 Scanloom`;
  setText(byId('chosen', HTMLElement), name);
  sessionPanel.choose(name);
  viewer.watch(name);
}

/** Without a choice, the session where something happens, or else the newest. */
async function chooseFrom(sessions: Session[], signal: AbortSignal): Promise<void> {
  const newestFirst = [...sessions].sort((a, b) => b.created.localeCompare(a.created));
  const live = newestFirst.find(({ robots }) => robots.some(({ connected }) => connected));
  const choice = live ?? newestFirst[0];
  if (!choice) {
    robotPort ??= await fetchRobotPort(signal);
    notice.show({ kind: 'no-sessions', robots: robotPort, pageHost: location.hostname });
    return;
  }
  history.replaceState(null, '', hashOfSession(choice.name));
  openChosen();
}

async function refreshSessions(signal: AbortSignal): Promise<void> {
  const answer = await fetchSessions(signal);
  const learnt = answer.sessions.map((session) => newest.learn(session));
  const sessions = sessionPanel.show(learnt, answer.damaged);
  const chosen = sessionOfHash(location.hash);
  if (chosen === null) return chooseFrom(sessions, signal);
  for (const session of sessions) if (session.name === chosen) viewer.refresh(session);
  for (const session of answer.damaged) if (session.name === chosen) explain(session);
}

/** Between two rounds; what goes wrong, the next round tells. */
async function refreshOnce(): Promise<void> {
  if (refreshing) return;
  refreshing = true;
  await refreshSessions(new AbortController().signal).catch(() => {});
  refreshing = false;
}

/** The person knows that it is gone: the page goes to another one, or waits until there is one. */
function leaveDeleted(name: string): void {
  if (sessionOfHash(location.hash) === name) {
    viewer.close();
    history.replaceState(null, '', location.pathname + location.search);
    document.title = 'Scanloom';
    setText(byId('chosen', HTMLElement), '');
    notice.show({ kind: 'loading' });
    if (sessionPanel.all.length > 0) void chooseFrom(sessionPanel.all, new AbortController().signal);
  }
  ending.delete(name);
}

function explain({ name, reason }: DamagedSession): void {
  notice.show({ kind: 'damaged', name, reason });
}

function connectControls(): void {
  byId('zoom-in', HTMLButtonElement).addEventListener('click', () => camera.zoomBy(1));
  byId('zoom-out', HTMLButtonElement).addEventListener('click', () => camera.zoomBy(-1));
  byId('fit', HTMLButtonElement).addEventListener('click', () => camera.fit());
  panelToggle.addEventListener('click', () => setPanel(panelToggle.getAttribute('aria-expanded') !== 'true'));
}

/** Matters on a phone only, where the panel covers most of the map. */
function setPanel(open: boolean): void {
  panelToggle.setAttribute('aria-expanded', String(open));
  byId('panel', HTMLElement).classList.toggle('open', open);
}

/** The address tells what is seen, without another entry in the browser's history for each layer. */
function rememberLayer(): void {
  const hash = hashWithLayer(location.hash, picture.now.layer);
  if (sessionOfHash(hash) !== null && hash !== location.hash) history.replaceState(null, '', hash);
}

function bindKeys(): void {
  keys.bind({ key: 'v', does: 'shows the next layer', run: () => picture.step(1) });
  keys.bind({ key: 'b', does: 'shows the layer before', run: () => picture.step(-1) });
  keys.bind({ key: 'g', does: 'shows HIMM counters in the cells, when zoomed in', run: toggleCounters });
  keys.bind({ key: '/', does: 'searches the sessions', run: () => sessionPanel.focusSearch() });
  keys.bind({ key: 'f', does: 'fits the whole map', run: () => camera.fit() });
}

/** Of what is drawn on canvases. */
function takeColours(): void {
  const theme = readTheme();
  mapView.setTheme(theme);
  sessionPanel.setTheme(theme);
  serverCharts.takeColours();
}

function addTools(): void {
  const comparison = new Comparison(picture);
  const importing = importTool();
  const context: ToolContext = {
    ...{ map, target, picture, theme: readTheme },
    session: () => viewer.session,
    robots: () => viewer.robots,
  };
  toolbox.add(measureTool(map, target, readTheme));
  toolbox.add(pathTool(context));
  toolbox.add(coverageTool(context));
  toolbox.add(weaveTool(context, comparison));
  toolbox.add(importing);
  toolbox.add(exportTool(context));
  viewer.listen((session) => session ?? comparison.end());
  settings.listen(() => map.getLayers().forEach((layer) => layer.changed()));
  byId('import-open', HTMLButtonElement).addEventListener('click', () => {
    setPanel(false);
    toolbox.toggle(importing);
  });
}

function toggleCounters(): void {
  settings.change({ counters: !settings.get().counters });
}

showScale(map, byId('scale', HTMLElement));
connectControls();
bindKeys();
new LayersPanel(
  {
    layers: byId('layers', HTMLElement),
    note: byId('layer-note', HTMLElement),
    legend: byId('legend', HTMLElement),
    opacity: byId('opacity', HTMLInputElement),
    beside: byId('beside', HTMLSelectElement),
    besideOptions: byId('beside-options', HTMLElement),
    besideOpacity: byId('beside-opacity', HTMLInputElement),
    besideLegend: byId('beside-legend', HTMLElement),
    swipe: byId('mode-swipe', HTMLInputElement),
    over: byId('mode-over', HTMLInputElement),
    overlays: byId('overlays', HTMLElement),
  },
  picture,
  settings,
);
new SwipeHandle(byId('swipe', HTMLElement), target, picture);
new DisplayPanel(
  {
    scheme: byId('scheme', HTMLSelectElement),
    palette: byId('palette', HTMLSelectElement),
    keysOpen: byId('keys-open', HTMLButtonElement),
    keys: byId('keys', HTMLDialogElement),
    keysBody: byId('keys-body', HTMLElement),
  },
  settings,
  keys,
);
addTools();
settings.listen(takeColours);
const past = new SessionHistory(viewer, picture);
new TimeBar(byId('time-bar', HTMLElement), byId('history-open', HTMLButtonElement), past, keys);
viewer.listen((session) => session ?? toolbox.close());
picture.listen(rememberLayer);
window.addEventListener('hashchange', () => {
  setPanel(false);
  openChosen();
});
notice.show({ kind: 'loading' });
openChosen();
void poll(refreshSessions, kSessionsPace, new AbortController().signal, (error) => {
  status.settle('sessions', error);
  sessionPanel.settle(error);
});
