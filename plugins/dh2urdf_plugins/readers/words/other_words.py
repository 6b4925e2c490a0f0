"""What other languages than English call fields, types and conventions: needed where no English word is written."""

from __future__ import annotations

from functools import cache

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.row_fields import INERTIA
from dh2urdf_plugins.readers.words.word_keys import keys_of

LANGUAGES = {
    "de": "German",
    "fr": "French",
    "es": "Spanish",
    "it": "Italian",
    "pt": "Portuguese",
    "pl": "Polish",
    "tr": "Turkish",
    "ru": "Russian",
    "zh": "Chinese",
    "ja": "Japanese",
    "ko": "Korean",
}

_GERMAN = """robot: roboter, robotername, modell; convention: konvention; index: nummer, lfd nr, gelenknummer,
achsnummer; joint: gelenk, gelenkname, achse, achsname; link: glied, armglied; type: typ, gelenktyp, achstyp,
gelenkart; a: länge, gliedlänge, armlänge; alpha: verdrehung, verwindung, verdrehwinkel; d: gelenkabstand; theta:
gelenkwinkel, drehwinkel; sign: vorzeichen, drehrichtung; flip: invertiert; limits: grenzen, bereich, arbeitsbereich,
bewegungsbereich, schwenkbereich, winkelbereich; lower: untere, unterer, unteres, untergrenze, grenze unten, minimal,
minimaler, minimale; upper: obere, oberer, oberes, obergrenze, grenze oben, maximal, maximaler, maximale; velocity:
geschwindigkeit, winkelgeschwindigkeit; effort: drehmoment, kraft, maximalmoment; mass: masse, gewicht; com:
schwerpunkt, massenschwerpunkt, schwerpunktlage; inertia: trägheit, trägheitstensor, trägheitsmatrix, trägheitsmoment,
massenträgheit; damping: dämpfung, viskose reibung; friction: reibung, coulombsche reibung, trockene reibung"""
_FRENCH = """robot: manipulateur, modèle, nom du robot; index: numéro, indice; joint: articulation, nom, nom de
l'articulation, axe, liaison; link: corps, maillon; type: type d'articulation, type de liaison; a: longueur, longueur
du corps, longueur du segment; alpha: torsion, angle de torsion; theta: angle articulaire; sign: signe, sens, sens de
rotation; flip: inversé; limits: limites, plage, débattement, course; lower: inférieure, inférieur, mini, minimale;
upper: supérieure, supérieur, maxi; velocity: vitesse, vitesse angulaire; effort: couple; mass: poids; com: centre de
masse, centre de gravité; inertia: inertie, matrice d'inertie, tenseur d'inertie, moment d'inertie; radius: rayon;
damping: amortissement, frottement visqueux; friction: frottement, frottement sec"""
_SPANISH = """robot: manipulador, modelo, nombre del robot; convention: convención; index: número, índice; joint:
articulación, nombre, eje, junta; link: eslabón; type: tipo, tipo de articulación, tipo de junta; a: longitud,
longitud del eslabón; alpha: alfa, torsión, ángulo de torsión; theta: ángulo articular, ángulo de articulación; sign:
signo, sentido, sentido de giro; flip: invertido; limits: límites, rango, recorrido, carrera; lower: inferior, mínimo,
mínima; upper: superior, máximo, máxima; velocity: velocidad, velocidad angular; effort: par máximo, par max, par de
torsión, fuerza; mass: masa, peso; com: centro de masa, centro de masas, centro de gravedad; inertia: inercia, matriz
de inercia, tensor de inercia, momento de inercia; radius: radio; damping: amortiguamiento, fricción viscosa;
friction: fricción, fricción seca"""
_ITALIAN = """robot: manipolatore, modello, nome del robot; convention: convenzione; index: numero; joint: giunto,
nome, nome del giunto, asse, articolazione; link: membro; type: tipo, tipo di giunto; a: lunghezza, lunghezza del
link; alpha: alfa, torsione, angolo di torsione; theta: angolo di giunto; sign: segno, verso, senso di rotazione;
flip: invertito; limits: limiti, corsa, escursione; lower: inferiore, minimo, minima; upper: superiore, massimo,
massima; velocity: velocità, velocità angolare; effort: coppia, forza; mass: massa; com: centro di massa, baricentro;
inertia: inerzia, matrice d'inerzia, tensore d'inerzia, momento d'inerzia; radius: raggio; damping: smorzamento,
attrito viscoso; friction: attrito, attrito secco"""
_PORTUGUESE = """robot: robô, manipulador, modelo, nome do robô; convention: convenção; index: número, índice;
joint: junta, articulação, eixo, nome, nome da junta; link: elo, nome do elo; sign: sinal, sentido, sentido de
rotação; type: tipo, tipo de junta, tipo de articulação; a: comprimento, comprimento do elo; flip: invertido;
alpha: alfa, torção, torção do elo, ângulo de torção; d: deslocamento, deslocamento do elo, deslocamento da junta;
theta: ângulo da junta, ângulo de junta, ângulo articular, ângulo de articulação; radius: raio; mass: massa, peso;
limits: limites, faixa, faixa de movimento, curso; lower: inferior, mínimo, mínima; upper: superior, máximo,
máxima; velocity: velocidade, velocidade angular; effort: torque máximo, força; com: centro de massa, centro de
gravidade; inertia: inércia, matriz de inércia, tensor de inércia, momento de inércia; damping: amortecimento,
atrito viscoso; friction: atrito, atrito seco"""
_CHINESE = """robot: 机器人, 机械臂; index: 序号, 编号, 关节序号, 关节编号, 轴号; joint: 关节, 关节名称, 轴, 名称;
link: 连杆, 杆件, 连杆名称; type: 类型, 关节类型, 运动副, 运动副类型; sign: 方向, 旋转方向; a: 连杆长度, 杆长,
杆件长度; alpha: 连杆扭转, 连杆扭角, 连杆扭转角, 连杆转角, 扭转角; d: 连杆偏移, 连杆偏距, 连杆偏置, 偏距,
关节偏距; theta: 关节角, 关节角度, 关节转角, 转角; limits: 关节范围, 运动范围, 活动范围, 角度范围, 工作范围, 范围;
lower: 下限, 最小, 最小值; upper: 上限, 最大, 最大值; velocity: 速度, 角速度, 最大速度, 最大角速度; effort: 力矩,
扭矩, 转矩, 最大力矩, 最大扭矩; mass: 质量; com: 质心, 质心位置, 重心; radius: 半径; inertia: 惯性张量, 惯量,
惯性矩阵, 惯量矩阵, 转动惯量; damping: 阻尼, 粘性摩擦; friction: 摩擦, 库仑摩擦"""
_POLISH = """robot: manipulator, nazwa robota; convention: konwencja; index: numer, lp, numer przegubu, numer osi;
joint: przegub, złącze, staw, oś, nazwa, nazwa przegubu; link: ogniwo, człon; type: typ, rodzaj, typ przegubu,
rodzaj przegubu, typ złącza; a: długość, długość członu, długość ogniwa; alpha: skręcenie, kąt skręcenia,
skręcenie członu, kąt skręcenia członu, skręcenie ogniwa; d: odsunięcie, odsunięcie członu, przesunięcie członu,
odsunięcie ogniwa; theta: kąt obrotu, kąt przegubu, kąt złącza, kąt konfiguracji; limits: zakres, zakres ruchu,
ograniczenia; lower: dolna granica, minimalny, minimalna; upper: górna granica, maksymalny, maksymalna; velocity:
prędkość, prędkość kątowa, prędkość maksymalna, maksymalna prędkość; effort: moment obrotowy, maksymalny moment,
siła; mass: masa; com: środek masy, środek ciężkości; inertia: tensor bezwładności, moment bezwładności, momenty
bezwładności, macierz bezwładności; radius: promień"""
_TURKISH = """robot: robot adı; index: sıra, no, eklem no, eklem numarası; joint: eklem, mafsal, eksen, eklem adı;
link: uzuv, kol; type: tip, tür, eklem tipi, eklem türü, mafsal tipi; a: uzunluk, uzuv uzunluğu, kol uzunluğu, bağ
uzunluğu; alpha: burulma, burulma açısı, uzuv burulması, uzuv burulma açısı; d: öteleme, eklem ötelemesi, uzuv
ötelemesi, eklem kaçıklığı, uzuv kaçıklığı; theta: eklem açısı, dönme açısı; limits: sınırlar, aralık, hareket
aralığı, çalışma aralığı, eklem sınırları, eklem limitleri; lower: alt sınır, alt limit, en az; upper: üst sınır,
üst limit, en çok; velocity: hız, açısal hız, maksimum hız; effort: tork, maksimum tork, kuvvet; mass: kütle,
ağırlık; com: kütle merkezi, ağırlık merkezi; inertia: atalet, eylemsizlik, atalet momenti, eylemsizlik momenti,
atalet tensörü; radius: yarıçap"""
_RUSSIAN = """robot: робот, манипулятор, модель; convention: соглашение; index: номер, номер звена, номер
сочленения, номер шарнира; joint: сочленение, шарнир, сустав, ось, название, имя; link: звено, название звена;
type: тип, тип пары, тип сочленения, тип шарнира, тип сустава, тип кинематической пары, вид пары; a: длина, длина
звена; alpha: скручивание, угол скручивания, угол скручивания звена, угол закручивания, скручивание звена; d:
смещение, смещение звена; theta: угол поворота, угол сочленения, угол в сочленении, угол шарнира, присоединенный
угол; limits: пределы, диапазон, ограничения, диапазон движения, рабочий диапазон; lower: нижний предел, минимум,
минимальный, минимальное, мин; upper: верхний предел, максимум, максимальный, максимальное, макс; velocity:
скорость, угловая скорость, максимальная скорость; effort: момент, крутящий момент, максимальный момент, усилие,
сила; mass: масса, масса звена; com: центр масс, центр тяжести; inertia: тензор инерции, момент инерции, моменты
инерции, матрица инерции; radius: радиус"""
_JAPANESE = """robot: ロボット, マニピュレータ; index: 番号, 関節番号, リンク番号, 軸番号; joint: 関節,
ジョイント, 軸, 関節名, 名前; link: リンク, リンク名; type: 種類, タイプ, 関節の種類, 関節タイプ; a: リンク長,
リンク長さ, リンクの長さ; alpha: ねじれ角, ねじり角, リンクねじれ角, リンクのねじれ角; d: リンクオフセット,
リンク間距離, オフセット距離; theta: 関節角, 関節角度, 回転角; limits: 可動範囲, 動作範囲, 可動域; lower: 下限,
最小, 最小値, 最小角度; upper: 上限, 最大, 最大値, 最大角度; velocity: 速度, 角速度, 最大速度; effort: トルク,
最大トルク; mass: 質量, 重量; com: 重心, 重心位置, 質量中心; inertia: 慣性テンソル, 慣性モーメント; radius: 半径"""
_KOREAN = """robot: 로봇, 매니퓰레이터; index: 번호, 관절 번호, 축 번호; joint: 관절, 조인트, 축, 관절명, 관절
이름; link: 링크, 링크명; type: 종류, 유형, 타입, 관절 종류, 관절 유형, 관절 타입; a: 링크 길이, 길이; alpha:
비틀림, 링크 비틀림, 비틀림 각, 링크 비틀림 각; d: 링크 오프셋, 링크 변위; theta: 관절각, 관절 각도, 회전각;
limits: 가동 범위, 동작 범위, 구동 범위, 관절 한계; lower: 하한, 최소, 최소값; upper: 상한, 최대, 최대값;
velocity: 속도, 각속도, 최대 속도; effort: 토크, 최대 토크; mass: 질량, 무게; com: 무게중심, 질량 중심; inertia:
관성 텐서, 관성 모멘트; radius: 반지름"""
_OF_AXES = {
    "de": ("schwerpunkt *, * schwerpunkt, massenschwerpunkt *", "trägheit *"),
    "fr": ("centre de masse *, centre de gravité *", "inertie *"),
    "es": ("centro de masa *, centro de masas *, centro de gravedad *", "inercia *"),
    "it": ("centro di massa *, baricentro *", "inerzia *"),
    "pt": ("centro de massa *, centro de gravidade *", "inércia *"),
    "zh": ("质心 *, 重心 *", "惯量 *"),
}
"""Headers of one coordinate of a centre of mass, and of one moment of inertia; its axes are in the place of ``*``."""


@cache
def other_headers() -> dict[str, dict[str, tuple[str, ...]]]:
    """The headers of each field, by language."""
    texts = {
        "de": _GERMAN,
        "fr": _FRENCH,
        "es": _SPANISH,
        "it": _ITALIAN,
        "pt": _PORTUGUESE,
        "pl": _POLISH,
        "tr": _TURKISH,
        "ru": _RUSSIAN,
        "zh": _CHINESE,
        "ja": _JAPANESE,
        "ko": _KOREAN,
    }
    found: dict[str, dict[str, tuple[str, ...]]] = {}
    for language, text in texts.items():
        for entry in " ".join(text.split()).split("; "):
            field, headers = entry.split(": ")
            found.setdefault(field, {})[language] = tuple(headers.split(", "))
    for language, (centre, moment) in _OF_AXES.items():
        for field, headers in ((f"com_{axis}", centre.replace("*", axis)) for axis in "xyz"):
            found.setdefault(field, {})[language] = tuple(headers.split(", "))
        for field in INERTIA:
            found.setdefault(field, {})[language] = (moment.replace("*", field[1:]),)
    return found


_TYPES = {
    JointType.REVOLUTE: "drehgelenk, rotationsgelenk, drehachse, rotatorisch, rotoïde, rotatif, rotacional, rotatoria, "
    "rotatorio, rotativa, rotativo, giratoria, giratorio, revoluta, rotoidale, 转动, 旋转, 回转, 转动副, 旋转副, "
    "вращательная, вращательный, вращательное, obrotowy, obrotowa, obrotowe, döner, dönel, "
    "回転, 回転関節, 회전, 회전관절, rev, rot, revolving, rotante, rotoidal, giratória, rotacyjny, rotacyjna",
    JointType.PRISMATIC: "schubgelenk, linearachse, lineargelenk, prismatisch, translatorisch, prismatique, glissière, "
    "linéaire, prismático, prismática, lineal, prismatico, prismatica, lineare, 移动, 平移, 直线, 移动副, 棱柱, 直动, "
    "поступательная, поступательный, поступательное, призматическая, призматический, призматическое, przesuwny, "
    "przesuwna, przesuwne, pryzmatyczny, pryzmatyczna, postępowy, prizmatik, kayar, "
    "линейная, линейный, liniowy, liniowa, doğrusal, 直動, 直動関節, 並進, 직동, 직동관절, 병진, 직선, "
    "pris, prism, trans, transl, traslacional, translacional, traslazionale, translatif",
    JointType.FIXED: "fest, fixe, fijo, fija, fisso, fissa, fixo, fixa, 固定, неподвижная, неподвижный, "
    "фиксированная, фиксированный, nieruchomy, stały, sabit, 고정",
}
_CONVENTIONS = {
    Convention.STANDARD: "estándar, klassisch, klassische, classique, clásica, clásico, classica, classico, clássica, "
    "standardowa, klasyczna, klasik, стандартная, классическая, 标准, 经典, 標準, 표준, "
    "标准dh, 標準dh, 经典dh",
    Convention.MODIFIED: "modifiziert, modifizierte, modifiée, modifié, modificada, modificado, modificata, "
    "modificato, zmodyfikowana, değiştirilmiş, модифицированная, 改进, 改良, 修正, 수정, 改进dh, 改良dh, 修正dh",
}
OTHER_TYPES = {key: kind for kind, words in _TYPES.items() for word in words.split(", ") for key in keys_of(word)}
"""Types of joints by the keys of words for them."""
OTHER_CONVENTIONS = {
    key: kind for kind, words in _CONVENTIONS.items() for word in words.split(", ") for key in keys_of(word)
}
"""Conventions by the keys of words for them."""
