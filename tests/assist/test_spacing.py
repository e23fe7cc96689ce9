"""Blanks in a row of code."""

from __future__ import annotations

import pytest

from elitescript.assist.spacing import spaced
from elitescript.language.text.masked import lex

ROWS = [
    ("a=1", "a = 1"),
    ("a  =  1", "a = 1"),
    ("a=b=c+=1", "a = b = c += 1"),
    ("x=a+b-c*d/e//f%g@h**i", "x = a + b - c * d / e // f % g @ h ** i"),
    ("x=a<<b>>c&d|e^f", "x = a << b >> c & d | e ^ f"),
    ("a//=2;b**=3;c>>=1", "a //= 2; b **= 3; c >>= 1"),
    ("if a<b<=c==d!=e>=f>g:", "if a < b <= c == d != e >= f > g:"),
    ("x=-a+-b", "x = -a + -b"),
    ("x=a- b", "x = a - b"),
    ("f(- 1,+ 2,~ 3)", "f(-1, +2, ~3)"),
    ("return-1", "return -1"),
    ("x=a*-b**-c", "x = a * -b ** -c"),
    ("x = not-a", "x = not -a"),
    ("x = - -a", "x = - -a"),
    ("f ( a , b )", "f(a, b)"),
    ("f ( )", "f()"),
    ("movej ( q,a = 1.4,v= 1.05 )", "movej(q, a=1.4, v=1.05)"),
    ("f(*a,** b)", "f(*a, **b)"),
    ("f(a*b,** c)", "f(a * b, **c)"),
    ("first,* rest=q", "first, *rest = q"),
    ("x = ( a, )", "x = (a,)"),
    ("x=[ 1,2 ,3 ]", "x = [1, 2, 3]"),
    ("x = a [ 0 ] [ 1 ]", "x = a[0][1]"),
    ("x=a[1 : -1 : 2]", "x = a[1:-1:2]"),
    ("x=a[ : , 0]", "x = a[:, 0]"),
    ("x=a[b+1 :c]", "x = a[b + 1:c]"),
    ("x={'a' :1,'b':a [1 :2]}", "x = {'a': 1, 'b': a[1:2]}"),
    ("x={1:lambda:0}", "x = {1: lambda: 0}"),
    ("x=a[lambda y=1 : y]", "x = a[lambda y=1: y]"),
    ("f=lambda x,y = 2,*z:x+y", "f = lambda x, y=2, *z: x + y"),
    ("f(key = lambda q :q [1])", "f(key=lambda q: q[1])"),
    ("def f ( a,b = 1 ) :", "def f(a, b=1):"),
    ("def f(a:int=1,b = 2,*,c:float=3)->int:", "def f(a: int = 1, b=2, *, c: float = 3) -> int:"),
    ("def f(a=g(b = 1)): x={1:2};h(c = 3)", "def f(a=g(b=1)): x = {1: 2}; h(c=3)"),
    ("def f(a,/,b):", "def f(a, /, b):"),
    ("sec  s ( ) :", "sec s():"),
    ("class A ( B,metaclass = C ):", "class A(B, metaclass=C):"),
    ("x:int=3", "x: int = 3"),
    ("if(a):", "if (a):"),
    ("while(True) :", "while (True):"),
    ("else :", "else:"),
    ("if a :b();c() ;", "if a: b(); c();"),
    ("x = a if(b)else(c)", "x = a if (b) else (c)"),
    ("x = (a)if b else[c]", "x = (a) if b else [c]"),
    ("x = not(a)and(b)or c in(d)", "x = not (a) and (b) or c in (d)"),
    ("for i in range ( 3 ) :", "for i in range(3):"),
    ("x=[i for i in(1,2)if i]", "x = [i for i in (1, 2) if i]"),
    ("a . b . c ( )", "a.b.c()"),
    ("x=1 .real", "x = 1 .real"),
    ("x=1.5.real", "x = 1.5.real"),
    ("x=1e-3+2.5E+4j-0xff", "x = 1e-3 + 2.5E+4j - 0xff"),
    ("x=1if y else 2", "x = 1 if y else 2"),
    ("from . import a", "from . import a"),
    ("from .b import(c)", "from .b import (c)"),
    ("from math import*", "from math import *"),
    ("import a  ,b   as c", "import a, b as c"),
    ("@ cached", "@cached"),
    ("f(a:=1)", "f(a := 1)"),
    ("x='a  b'  'c'+\"d\" [0]", "x = 'a  b' 'c' + \"d\"[0]"),
    ("x=f'{a:  >5}' %b", "x = f'{a:  >5}' % b"),
    ("x='%d'%(1)", "x = '%d' % (1)"),
    ("f(end = '')", "f(end='')"),
    ("end=min(a)", "end = min(a)"),
    ("end ;", "end;"),
    ("with a as b,c as d :", "with a as b, c as d:"),
    ("except(A,B)as e:", "except (A, B) as e:"),
    ("x=...", "x = ..."),
    ("x=a[...,0]", "x = a[..., 0]"),
    ("print(* a)", "print(*a)"),
    ("yield", "yield"),
    ("x=(yield)", "x = (yield)"),
    ("global a,b", "global a, b"),
    ("坐标=变量 [ 0 ]", "坐标 = 变量[0]"),
    ("match[ 0 ]=1", "match[0] = 1"),
]


def row(text: str, is_header: bool = False) -> str:
    return spaced(text, lex(text).masked, is_header)


@pytest.mark.parametrize(("old", "new"), ROWS)
def test_blanks(old, new):
    assert row(old, is_header=old.endswith(":")) == new
    assert row(new, is_header=old.endswith(":")) == new


def test_soft_keywords_are_keywords_in_headers_alone():
    assert row("match(a):", is_header=True) == "match (a):"
    assert row("case[a,b]:", is_header=True) == "case [a, b]:"
    assert row("case{'a' :1,**rest}:", is_header=True) == "case {'a': 1, **rest}:"
    assert row("match (a)") == "match(a)"


@pytest.mark.parametrize("text", ["$ LINE:  (1 ,'a')", "a  ?b", "a !b", "a  =`b`"])
def test_a_row_with_signs_that_mean_nothing_stays(text):
    assert row(text) == text
