"""Lists the modules that a program can import and their names, by how they are provided.

Plain data, shared by the checker, the runtime and editors.
"""

from __future__ import annotations

from typing import Final

SHARED_NAMES: Final[dict[str, str]] = {
    "base64": "b64encode b64decode standard_b64encode standard_b64decode urlsafe_b64encode urlsafe_b64decode"
    " b32encode b32decode b16encode b16decode b85encode b85decode a85encode a85decode encodebytes decodebytes",
    "binascii": "a2b_base64 a2b_hex a2b_uu b2a_base64 b2a_hex b2a_uu crc32 crc_hqx hexlify unhexlify Error Incomplete",
    "bisect": "bisect bisect_left bisect_right insort insort_left insort_right",
    "cmath": "*",
    "decimal": "Decimal Context getcontext setcontext localcontext Clamped ConversionSyntax DecimalException"
    " DivisionByZero DivisionImpossible DivisionUndefined FloatOperation Inexact InvalidContext InvalidOperation"
    " Overflow Rounded Subnormal Underflow MAX_EMAX MAX_PREC MIN_EMIN MIN_ETINY ROUND_05UP ROUND_CEILING ROUND_DOWN"
    " ROUND_FLOOR ROUND_HALF_DOWN ROUND_HALF_EVEN ROUND_HALF_UP ROUND_UP",
    "hashlib": "md5 sha1 sha224 sha256 sha384 sha512 sha3_224 sha3_256 sha3_384 sha3_512 shake_128 shake_256 blake2b"
    " blake2s new pbkdf2_hmac algorithms_guaranteed",
    "heapq": "heappush heappop heapify heapreplace heappushpop merge nlargest nsmallest",
    "math": "*",
    "operator": "abs add and_ concat contains countOf delitem eq floordiv ge getitem gt iadd iand iconcat ifloordiv"
    " ilshift imatmul imod imul index indexOf inv invert ior ipow irshift is_ is_not isub itemgetter itruediv ixor le"
    " length_hint lshift lt matmul mod mul ne neg not_ or_ pos pow rshift setitem sub truediv truth xor",
    "struct": "calcsize error iter_unpack pack pack_into unpack unpack_from Struct",
}
"""Names of the installed module; `*` stands for all its public ones. Without functions that return any attribute."""

COPIED_NAMES: Final[dict[str, str]] = {
    "collections": "ChainMap Counter OrderedDict UserDict UserList UserString defaultdict deque namedtuple",
    "collections.abc": "*",
    "copy": "copy deepcopy Error",
    "dataclasses": "FrozenInstanceError InitVar KW_ONLY MISSING asdict astuple dataclass field fields is_dataclass"
    " replace",
    "enum": "CONFORM CONTINUOUS EJECT Enum EnumCheck Flag FlagBoundary IntEnum IntFlag KEEP NAMED_FLAGS ReprEnum STRICT"
    " StrEnum UNIQUE auto member nonmember property unique verify",
    "fractions": "Fraction",
    "functools": "cache cached_property cmp_to_key lru_cache partial partialmethod reduce total_ordering update_wrapper"
    " wraps",
    "json": "JSONDecodeError JSONDecoder JSONEncoder dump dumps load loads",
    "queue": "Empty Full LifoQueue PriorityQueue Queue SimpleQueue ShutDown",
    "statistics": "*",
    "string": "Template ascii_letters ascii_lowercase ascii_uppercase capwords digits hexdigits octdigits printable"
    " punctuation whitespace",
    "textwrap": "TextWrapper dedent fill indent shorten wrap",
    "threading": "Barrier BoundedSemaphore BrokenBarrierError Condition Event Lock RLock Semaphore TIMEOUT_MAX Thread"
    " ThreadError Timer active_count activeCount current_thread currentThread enumerate get_ident get_native_id local"
    " main_thread",
    "typing": "AbstractSet Annotated Any AnyStr AsyncIterable AsyncIterator Awaitable BinaryIO ByteString Callable"
    " ChainMap ClassVar Collection Concatenate Container ContextManager Coroutine Counter DefaultDict Deque"
    " Dict Final FrozenSet Generator Generic Hashable IO ItemsView Iterable Iterator KeysView List Literal"
    " LiteralString Mapping MappingView Match MutableMapping MutableSequence MutableSet NamedTuple Never"
    " NewType NoReturn NotRequired Optional OrderedDict ParamSpec ParamSpecArgs ParamSpecKwargs Pattern"
    " Protocol Required Reversible Self Sequence Set Sized SupportsAbs SupportsBytes SupportsComplex"
    " SupportsFloat SupportsIndex SupportsInt SupportsRound TYPE_CHECKING Text TextIO Tuple Type TypeAlias"
    " TypeGuard TypeVar TypeVarTuple TypedDict Union Unpack ValuesView assert_never assert_type cast"
    " dataclass_transform final get_args get_origin is_typeddict no_type_check overload override"
    " runtime_checkable",
}
"""Names of a private copy; those that this Python does not have are left out."""

OWN_NAMES: Final[dict[str, str]] = {
    "datetime": "MAXYEAR MINYEAR UTC date datetime time timedelta timezone tzinfo",
    "elicopy": "Error copy deepcopy",
    "itertools": "accumulate batched chain combinations combinations_with_replacement compress count cycle dropwhile"
    " filterfalse groupby islice pairwise permutations product repeat starmap takewhile tee zip_longest",
    "os": "curdir environ extsep getcwd getenv getpid getppid kill linesep listdir makedirs mkdir name pardir path"
    " pathsep remove sep unlink",
    "os.path": "abspath basename commonprefix curdir dirname exists expanduser extsep getmtime getsize isabs isdir"
    " isfile join normcase normpath pardir realpath relpath sep split splitdrive splitext",
    "random": "Random betavariate choice choices expovariate gammavariate gauss getrandbits getstate lognormvariate"
    " normalvariate paretovariate randbytes randint random randrange sample seed setstate shuffle triangular uniform"
    " vonmisesvariate weibullvariate",
    "re": "A ASCII DOTALL I IGNORECASE M MULTILINE Match NOFLAG Pattern RegexFlag S U UNICODE VERBOSE X compile error"
    " escape findall finditer fullmatch match search split sub subn",
    "signal": "SIGABRT SIGALRM SIGCHLD SIGCONT SIGHUP SIGINT SIGKILL SIGPIPE SIGSTOP SIGTERM SIGUSR1 SIGUSR2 SIG_DFL"
    " SIG_IGN getsignal signal",
    "subprocess": "CalledProcessError CompletedProcess DEVNULL PIPE Popen STDOUT SubprocessError TimeoutExpired call"
    " check_call check_output run",
    "sys": "byteorder exit float_info maxsize platform stderr stdout version version_info",
    "time": "altzone asctime ctime daylight gmtime localtime mktime monotonic monotonic_ns perf_counter perf_counter_ns"
    " process_time process_time_ns sleep strftime strptime struct_time thread_time time time_ns timezone tzname",
}
"""Names of small modules of the runtime, in virtual time and over virtual processes, for tools; a test holds them
against the modules. What this Python does not have is missing."""

SHARED: Final = frozenset(SHARED_NAMES)
"""Functions and immutable classes of the installed module itself."""

COPIED: Final = frozenset(COPIED_NAMES)
"""Private copies of the installed module, one for each run."""

OWN: Final = frozenset(OWN_NAMES)
"""Small modules of the runtime."""

AVAILABLE: Final = SHARED | COPIED | OWN
"""Every name that `import` finds."""

NETWORK: Final = frozenset(("http", "socket", "ssl", "urllib", "xmlrpc"))
"""Packages that are refused because commands of the robot do their work."""
