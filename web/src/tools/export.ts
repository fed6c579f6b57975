/**
 * Exports the visible data as files: maps for programs and for people, trajectories, frontiers, logs, and a screenshot.
 */
import {
  checkFile,
  fetchFile,
  frontiersPath,
  landmarksPath,
  pointsPath,
  posesPath,
  logPath,
  mapFilePath,
  trajectoryPath,
  type MapFormat,
  type MapQuery,
} from '../api/export';
import { fetchPathFile } from '../api/path_file';
import type { Session } from '../api/types';
import { el, setText } from '../dom';
import * as format from '../format';
import { kLayers, kLayerTitles, isLayerName } from '../layers/layers';
import type { MapSource } from '../map/map_source';
import type { ToolContext } from './context';
import { button, labelled, selectOf } from './fields';
import { NewestOnly } from './newest_only';
import { Outcome } from './outcome';
import { saveBlob, saveFrom } from './save_file';
import { screenPicture } from './screen_picture';
import type { Tool } from './toolbox';

/** Maximum number of cells in one file of the server; CSV and NPY may allow fewer. */
const kCellsMax = 64_000_000;
const kMegabyte = 1_000_000;

/** A file that can be downloaded. */
interface Offer {
  label: string;
  /** Description of its use. */
  note: string;
  file: string;
  path: string;
  /** Its length is unlimited: the browser downloads it. */
  endless?: true;
  /** The session whose trajectories are read page by page. */
  pathsOf?: string;
}

export function exportTool(context: ToolContext): Tool {
  return {
    id: 'export',
    title: 'Export',
    key: 'e',
    does: 'saves the visible maps and logs as files',
    icon: 'M7.5 2.5h-5v11h5M6.5 8h8M11.5 5l3 3-3 3',
    open: (card, signal) => void new ExportCard(context, card, signal),
  };
}

class ExportCard {
  private readonly side = selectOf('side', [
    ['main', 'The map'],
    ['second', 'The second side'],
  ]);
  private readonly layer = selectOf(
    'layer',
    kLayers.map((layer) => [layer, kLayerTitles[layer]] as const),
  );
  private readonly extent = selectOf('extent', [
    ['all', 'The whole map'],
    ['view', 'The visible part'],
  ]);
  private readonly size = el('p', { class: 'quiet' });
  private readonly sideRow = labelled('Of', this.side);
  private readonly files = el('ul', { class: 'tool-files', 'aria-label': 'Files' });
  private readonly outcome = new Outcome();
  private readonly fetching: NewestOnly;

  constructor(
    private readonly context: ToolContext,
    card: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    this.fetching = new NewestOnly(
      signal,
      () => {},
      (error) => this.outcome.complain(error),
    );
    const { map, picture } = context;
    const rows = [this.sideRow, labelled('Layer', this.layer), labelled('Part', this.extent)];
    const form = el('form', { class: 'tool-form' }, ...rows);
    form.addEventListener('change', () => this.update());
    const screen = button('Screenshot', () => this.saveScreen());
    card.append(form, this.size, this.files, screen, this.outcome.element);
    const update = (): void => this.update();
    map.on('moveend', update);
    signal.addEventListener('abort', () => map.un('moveend', update));
    this.side.addEventListener('change', () => this.followLayer());
    picture.listen(() => this.followLayer(), signal);
    this.followLayer();
  }

  /** The shown layer is selected until the user selects another one. */
  private followLayer(): void {
    const shown = this.side.value === 'second' ? this.context.picture.second : this.context.picture.main;
    if (shown) this.layer.value = shown.layer;
    this.update();
  }

  private update(): void {
    const { picture } = this.context;
    const session = this.context.session();
    this.sideRow.hidden = picture.second === null;
    if (picture.second === null) this.side.value = 'main';
    const source = (this.side.value === 'second' ? picture.second : picture.main)?.source;
    if (!session || !source) return;
    const query = this.query(source);
    setText(this.size, this.describeSize(session, source, query));
    const offers = offersOf(session.name, query);
    const fingerprint = JSON.stringify(offers);
    if (this.files.dataset['offers'] === fingerprint) return;
    this.files.dataset['offers'] = fingerprint;
    this.files.replaceChildren(...offers.map((offer) => this.row(offer)));
  }

  private query({ weave }: MapSource): MapQuery {
    const layer = isLayerName(this.layer.value) ? this.layer.value : 'occupancy';
    return { layer, weave, box: this.extent.value === 'view' ? this.boxInView() : null };
  }

  private boxInView(): MapQuery['box'] {
    const { map } = this.context;
    const [minX = 0, minY = 0, maxX = 0, maxY = 0] = map.getView().calculateExtent(map.getSize());
    return [minX, minY, maxX, maxY];
  }

  private describeSize({ bounds }: Session, { cellSize }: MapSource, { box }: MapQuery): string {
    const seen = bounds ? [bounds.minX, bounds.minY, bounds.maxX, bounds.maxY] : [];
    const [minX = 0, minY = 0, maxX = 0, maxY = 0] = box ?? seen;
    const [across, up] = [maxX - minX, maxY - minY].map((metres) => Math.ceil(metres / cellSize));
    if (across === undefined || up === undefined) return '';
    const text = `About ${format.count(across)} \u00d7 ${format.count(up)} cells of ${format.cellSize(cellSize)}.`;
    if (across * up <= kCellsMax) return text;
    return `${text} That exceeds the server\u2019s limit for one file: zoom in and choose the visible part.`;
  }

  private row(offer: Offer): HTMLElement {
    const { label, note, path, file } = offer;
    const link = el('a', { href: path, download: file }, label);
    link.addEventListener('click', (event) => {
      // With a modifier key, the browser handles the click.
      if (event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
      event.preventDefault();
      this.save(offer);
    });
    return el('li', {}, link, el('span', { class: 'quiet' }, note));
  }

  private save({ label, file, path, endless, pathsOf }: Offer): void {
    this.fetching.run(async (signal) => {
      this.outcome.report(`The server creates ${label}\u2026`);
      if (endless) {
        await checkFile(path, signal);
        saveFrom(path, file);
        this.outcome.report(`The browser downloads ${file}.`);
        return;
      }
      const progress = (bytes: number): void => this.outcome.report(`${file}: ${megabytes(bytes)}\u2026`);
      const blob = await (pathsOf === undefined
        ? fetchFile(path, signal, progress)
        : fetchPathFile(pathsOf, signal, progress));
      saveBlob(blob, file);
      this.outcome.report(`Saved ${file}, ${megabytes(blob.size)}.`);
    });
  }

  private saveScreen(): void {
    const { map, target, theme, session } = this.context;
    const file = `${session()?.name ?? 'map'}-screen.png`;
    this.fetching.run(async () => {
      saveBlob(await screenPicture(map, target, theme().halo), file);
      if (!this.signal.aborted) this.outcome.report(`Saved ${file}.`);
    });
  }
}

function offersOf(session: string, query: MapQuery): Offer[] {
  const { layer, weave } = query;
  const base = layer === 'occupancy' ? session : `${session}-${layer}`;
  const map = (kind: MapFormat, label: string, note: string, file: string): Offer => ({
    ...{ label, note, file },
    path: mapFilePath(session, kind, query),
  });
  return [
    map('png', 'PNG', 'grey levels or colours', `${base}.png`),
    map('pgw', 'World file', 'places the PNG in QGIS', `${base}.pgw`),
    // The YAML file names the image: these two keep their names.
    map('pgm', 'PGM', 'image for ROS, as map.pgm', 'map.pgm'),
    map('yaml', 'YAML', 'goes with the PGM, as map.yaml', 'map.yaml'),
    map('csv', 'CSV', 'one number per cell', `${base}.csv`),
    map('npy', 'NPY', 'for NumPy', `${base}.npy`),
    {
      ...{ label: 'Trajectories (GeoJSON)', note: 'all positions of the robots, metres' },
      ...{ file: `${session}-trajectory.geojson`, path: trajectoryPath(session), pathsOf: session },
    },
    {
      ...{ label: 'Trajectories (TUM)', note: 'the pose of every scan, for evo and others' },
      ...{ file: `${session}-trajectory.tum`, path: posesPath(session, 'trajectory.tum') },
    },
    {
      ...{ label: 'Pose graph (g2o)', note: 'keyframes and edges of estimated poses' },
      ...{ file: `${session}-pose_graph.g2o`, path: posesPath(session, 'pose_graph.g2o') },
    },
    {
      ...{ label: 'Frontiers (GeoJSON)', note: 'borders of the explored ground' },
      ...{ file: `${session}-frontiers.geojson`, path: frontiersPath(session, weave) },
    },
    {
      ...{ label: 'Landmarks (GeoJSON)', note: 'landmarks that robots observed, metres' },
      ...{ file: `${session}-landmarks.geojson`, path: landmarksPath(session) },
    },
    {
      ...{ label: 'Points (CSV)', note: 'all scans as one point cloud, metres' },
      ...{ file: `${session}-points.csv`, path: pointsPath(session, 'csv') },
    },
    {
      ...{ label: 'Points (PLY)', note: 'the same point cloud for 3D programs' },
      ...{ file: `${session}-points.ply`, path: pointsPath(session, 'ply') },
    },
    {
      ...{ label: 'Points (PCD)', note: 'for the Point Cloud Library' },
      ...{ file: `${session}-points.pcd`, path: pointsPath(session, 'pcd') },
    },
    {
      ...{ label: 'CARMEN log', note: 'all scans, to replay', file: `${session}.clf` },
      ...{ path: logPath(session, 'clf'), endless: true },
    },
    {
      ...{ label: 'MCAP recording', note: 'for Foxglove, Lichtblick and ROS 2', file: `${session}.mcap` },
      ...{ path: logPath(session, 'mcap'), endless: true },
    },
    {
      ...{ label: 'Protobuf log', note: 'all scans as received', file: `${session}.scanlog` },
      ...{ path: logPath(session, 'protobuf'), endless: true },
    },
  ];
}

function megabytes(bytes: number): string {
  return bytes < kMegabyte ? `${format.count(Math.ceil(bytes / 1000))} kB` : `${(bytes / kMegabyte).toFixed(1)} MB`;
}
